#include "las/las_grid.h"
#include "las/las_notes.h"

#include <math.h>

/* Each nearest to its power of ten, as another program would read it. */
static const double decimal[] = { 1e0,  1e-1, 1e-2, 1e-3,  1e-4,  1e-5, 1e-6,
								  1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12 };
#define DECIMALS (sizeof decimal / sizeof *decimal)

static bool holds(const las_grid *grid, double value)
{
	return fabs((value - grid->offset) / grid->scale) < (double)INT32_MAX;
}

int32_t las_grid_place(const las_grid *grid, double value)
{
	return (int32_t)lrint((value - grid->offset) / grid->scale);
}

static bool gives_back(const las_grid *grid, const scan_column *column, size_t count)
{
	bool single = column->type == SCAN_FLOAT32;
	for (size_t i = 0; i < count; i++) {
		double value = scan_value(column, i);
		if (!holds(grid, value))
			return false;
		double back = las_grid_place(grid, value) * grid->scale + grid->offset;
		if (single ? (float)back != (float)value : back != value)
			return false;
	}
	return true;
}

/* A grid that a LAS file had which is part of the scan. */
static bool find_own(const scan *cloud, const scan_column *column, int axis, las_grid *grid)
{
	for (size_t c = 0; c + 1 < cloud->comment_count; c++) {
		double scale[3], offset[3];
		if (las_note_read(cloud->comment[c], "scale", scale, 3) != 3 ||
			las_note_read(cloud->comment[c + 1], "offset", offset, 3) != 3)
			continue;
		grid->scale = scale[axis];
		grid->offset = offset[axis];
		bool usable = isfinite(grid->scale) && grid->scale != 0.0 && isfinite(grid->offset);
		if (usable && gives_back(grid, column, cloud->count))
			return true;
	}
	return false;
}

static bool find_decimal(const scan *cloud, const scan_column *column, double middle,
						 las_grid *grid)
{
	for (size_t d = 0; d < DECIMALS; d++) {
		grid->scale = decimal[d];
		grid->offset = 0.0;
		if (gives_back(grid, column, cloud->count))
			return true;
		grid->offset = middle;
		if (gives_back(grid, column, cloud->count))
			return true;
	}
	return false;
}

/* The finest decimal grid around an offset that reaches from end to end. */
static bool find_finest(double minimum, double maximum, double middle, las_grid *grid)
{
	grid->offset = middle;
	for (size_t d = DECIMALS; d > 0 && decimal[d - 1] <= LAS_GRID_COARSEST; d--) {
		grid->scale = decimal[d - 1];
		if (holds(grid, minimum) && holds(grid, maximum))
			return true;
	}
	return false;
}

static gw_status find_bounds(const scan *cloud, const scan_column *column, const char *name,
							 double *minimum, double *maximum, gw_error *error)
{
	*minimum = cloud->count ? INFINITY : 0.0;
	*maximum = cloud->count ? -INFINITY : 0.0;
	for (size_t i = 0; i < cloud->count; i++) {
		double value = scan_value(column, i);
		if (!isfinite(value))
			return gw_fail(
				error, GW_ERROR_DATA,
				"%s: the coordinate %s of point %zu is no number, which LAS cannot hold; "
				"write PLY",
				name, column->name, i);
		*minimum = fmin(*minimum, value);
		*maximum = fmax(*maximum, value);
	}
	return GW_OK;
}

gw_status las_grid_find(const scan *cloud, int axis, const char *name, las_grid *grid,
						gw_error *error)
{
	static const char *const axes[3] = { "x", "y", "z" };
	const scan_column *column = scan_find(cloud, axes[axis]);
	double minimum, maximum;
	if (!column)
		return gw_fail(error, GW_ERROR_DATA, "%s: the points have no coordinate '%s'", name,
					   axes[axis]);
	GW_TRY(find_bounds(cloud, column, name, &minimum, &maximum, error));
	double middle = floor(0.5 * minimum + 0.5 * maximum);
	grid->exact = find_own(cloud, column, axis, grid) || find_decimal(cloud, column, middle, grid);
	if (!grid->exact && !find_finest(minimum, maximum, middle, grid))
		return gw_fail(
			error, GW_ERROR_DATA,
			"%s: %s goes from %g to %g, and the 32-bit numbers of LAS would round that to "
			"steps of over a millimetre; write PLY",
			name, column->name, minimum, maximum);
	double low = las_grid_place(grid, minimum) * grid->scale + grid->offset;
	double high = las_grid_place(grid, maximum) * grid->scale + grid->offset;
	grid->minimum = fmin(low, high);
	grid->maximum = fmax(low, high);
	return GW_OK;
}
