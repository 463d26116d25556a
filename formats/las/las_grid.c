#include "las/las_grid.h"
#include "glowworm_host.h"
#include "las/las_notes.h"

#include <math.h>
#include <stdlib.h>

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

static const char *const axes[3] = { "x", "y", "z" };

/* Whether two comments are the grid that a LAS file had which is part of the scan. */
static bool read_own(const scan *cloud, size_t comment, int axis, las_grid *grid)
{
	double scale[3], offset[3];
	if (las_note_read(cloud->comment[comment], "scale", scale, 3) != 3 ||
		las_note_read(cloud->comment[comment + 1], "offset", offset, 3) != 3)
		return false;
	*grid = (las_grid){ .scale = scale[axis], .offset = offset[axis], .exact = true };
	return isfinite(grid->scale) && grid->scale != 0.0 && isfinite(grid->offset);
}

static gw_status fail_memory(const char *name, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", name);
}

static gw_status begin(las_grid_search *s, const scan *cloud, int axis, const char *name,
					   gw_error *error)
{
	s->candidate = calloc(cloud->comment_count + 1, sizeof *s->candidate);
	if (!s->candidate)
		return fail_memory(name, error);
	for (size_t c = 0; c + 1 < cloud->comment_count; c++)
		s->count += read_own(cloud, c, axis, &s->candidate[s->count]);
	s->begun = true;
	s->minimum = INFINITY;
	s->maximum = -INFINITY;
	return GW_OK;
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

static gw_status add_bounds(las_grid_search *s, const scan *part, const scan_column *column,
							const char *name, gw_error *error)
{
	for (size_t i = 0; i < part->count; i++) {
		double value = scan_value(column, i);
		if (!isfinite(value))
			return gw_fail(
				error, GW_ERROR_DATA,
				"%s: the coordinate %s of point %llu is no number, which LAS cannot hold; "
				"write PLY or E57",
				name, column->name, (unsigned long long)(s->points + i));
		s->minimum = fmin(s->minimum, value);
		s->maximum = fmax(s->maximum, value);
	}
	return GW_OK;
}

/* alone: no other part comes, and what is behind the first that holds is not wanted */
static void try_candidates(las_grid_search *s, const scan *part, const scan_column *column,
						   bool alone)
{
	bool found = false;
	for (size_t c = 0; c < s->count; c++) {
		las_grid *grid = &s->candidate[c];
		grid->exact = grid->exact && !found && gives_back(grid, column, part->count);
		found = alone && (found || grid->exact);
	}
}

static gw_status add(las_grid_search *s, const scan *part, int axis, const char *name, bool alone,
					 gw_error *error)
{
	const scan_column *column = scan_find(part, axes[axis]);
	if (!column)
		return gw_fail(error, GW_ERROR_DATA, "%s: the points have no coordinate '%s'", name,
					   axes[axis]);
	if (!s->begun)
		GW_TRY(begin(s, part, axis, name, error));
	if (!s->decimal)
		GW_TRY(add_bounds(s, part, column, name, error));
	try_candidates(s, part, column, alone);
	s->points += part->count;
	return GW_OK;
}

gw_status las_grid_search_add(las_grid_search *s, const scan *part, int axis, const char *name,
							  gw_error *error)
{
	return add(s, part, axis, name, false, error);
}

static const las_grid *find_exact(const las_grid_search *s)
{
	size_t c = 0;
	while (c < s->count && !s->candidate[c].exact)
		c++;
	return c < s->count ? &s->candidate[c] : NULL;
}

static double middle_of(const las_grid_search *s)
{
	return s->points > 0 ? floor(0.5 * s->minimum + 0.5 * s->maximum) : 0.0;
}

/* Own grids are of the first round, decimal ones, about the middle that it finds, of the second. */
gw_status las_grid_search_go_on(las_grid_search *s, const char *name, bool *again, gw_error *error)
{
	*again = !s->decimal && s->begun && !find_exact(s);
	if (!*again)
		return GW_OK;
	double middle = middle_of(s);
	las_grid *candidate = calloc(DECIMALS, 2 * sizeof *candidate);
	if (!candidate)
		return fail_memory(name, error);
	for (size_t d = 0; d < 2 * DECIMALS; d++)
		candidate[d] =
			(las_grid){ .scale = decimal[d / 2], .offset = d % 2 ? middle : 0.0, .exact = true };
	free(s->candidate);
	s->candidate = candidate;
	s->count = 2 * DECIMALS;
	s->decimal = true;
	s->points = 0;
	return GW_OK;
}

/* A grid of a step about zero, or about the middle, that reaches from end to end. */
static bool find_coarse(double minimum, double maximum, double middle, las_grid *grid)
{
	const double offset[2] = { 0.0, middle };
	for (int k = 0; k < 2; k++) {
		grid->offset = offset[k];
		if (holds(grid, minimum) && holds(grid, maximum))
			return true;
	}
	return false;
}

gw_status las_grid_search_take(const las_grid_search *s, double step, int axis, const char *name,
							   las_grid *grid, gw_error *error)
{
	double minimum = s->points > 0 ? s->minimum : 0.0, maximum = s->points > 0 ? s->maximum : 0.0;
	const las_grid *exact = find_exact(s);
	bool fine = step > 0.0 && (!exact || fabs(exact->scale) < step);
	*grid = (las_grid){ .scale = step };
	bool found = fine && find_coarse(minimum, maximum, middle_of(s), grid);
	if (!found)
		*grid = exact ? *exact : (las_grid){ .exact = false };
	if (!found && !exact && !find_finest(minimum, maximum, middle_of(s), grid))
		return gw_fail(
			error, GW_ERROR_DATA,
			"%s: %s goes from %s to %s, and the 32-bit numbers of LAS would round that to "
			"steps of over a millimetre; write PLY",
			name, axes[axis], GW_SAID_PLACE(minimum), GW_SAID_PLACE(maximum));
	double low = las_grid_place(grid, minimum) * grid->scale + grid->offset;
	double high = las_grid_place(grid, maximum) * grid->scale + grid->offset;
	grid->minimum = fmin(low, high);
	grid->maximum = fmax(low, high);
	return GW_OK;
}

void las_grid_search_clear(las_grid_search *s)
{
	free(s->candidate);
	*s = (las_grid_search){ 0 };
}

gw_status las_grid_search_alone(las_grid_search *s, const scan *cloud, int axis, const char *name,
								gw_error *error)
{
	bool again;
	GW_TRY(add(s, cloud, axis, name, true, error));
	GW_TRY(las_grid_search_go_on(s, name, &again, error));
	return again ? add(s, cloud, axis, name, true, error) : GW_OK;
}

gw_status las_grid_find(const scan *cloud, int axis, const char *name, las_grid *grid,
						gw_error *error)
{
	las_grid_search search = { 0 };
	gw_status status = las_grid_search_alone(&search, cloud, axis, name, error);
	if (status == GW_OK)
		status = las_grid_search_take(&search, cloud->step, axis, name, grid, error);
	las_grid_search_clear(&search);
	return status;
}
