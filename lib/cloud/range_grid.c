/* range_grid.c - see range_grid.h */
#include "cloud/range_grid.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "cloud/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_LEAST 64u /* of an image that tells anything */
#define CELLS_MOST 16u   /* cells a point */
#define PAIRS 4096u      /* pairs of neighbours that the angle between cells is found from */
#define REGULAR 0.8      /* share of them that have to be at even angles */
#define UNEVEN 0.2       /* that two angles in a row may differ by */

bool gw_range_way(const gw_range_grid *grid, size_t cell, double way[3])
{
	uint32_t point = grid->point[cell];
	if (point == GW_NO_POINT)
		return false;
	for (size_t k = 0; k < 3; k++)
		way[k] = grid->points->position[3 * (size_t)point + k] - grid->image->scanner[k];
	return true;
}

static double length_of(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Does a point have a place that a ray may have met? */
static bool is_met(const gw_points *points, const gw_range_image *image, size_t point)
{
	double square = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double x = points->position[3 * point + k];
		if (!(fabs(x) <= GW_COORDINATE_MAX))
			return false;
		square += (x - image->scanner[k]) * (x - image->scanner[k]);
	}
	return square > 1e-12;
}

/* Sorts the image's points into its cells; the first one in a cell has it. */
static void fill_cells(gw_range_grid *grid)
{
	const gw_points *points = grid->points;
	const gw_range_image *image = grid->image;
	size_t cells = (size_t)image->columns * image->rows;
	memset(grid->point, 0xff, cells * sizeof *grid->point);
	for (size_t i = image->first; i < image->first + image->count; i++) {
		size_t cell = points->image_cell[i];
		if (cell < cells && grid->point[cell] == GW_NO_POINT && is_met(points, image, i))
			grid->point[cell] = (uint32_t)i;
	}
}

/* The angle between two cells; 0 when one of them is empty. */
static double angle_between(const gw_range_grid *grid, size_t cell, size_t other)
{
	double v[3], w[3], across[3];
	if (!gw_range_way(grid, cell, v) || !gw_range_way(grid, other, w))
		return 0.0;
	for (size_t k = 0; k < 3; k++)
		across[k] = v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3];
	return atan2(length_of(across), v[0] * w[0] + v[1] * w[1] + v[2] * w[2]);
}

/* The angle between neighbours; 0 when three cells in a row are not at even angles: then rows and
 * columns are no picture, or were not seen from anywhere near. */
static double find_step(const gw_range_grid *grid)
{
	size_t columns = grid->image->columns, rows = grid->image->rows, cells = columns * rows;
	float angle[PAIRS];
	size_t count = 0, even = 0, stride = cells / PAIRS + 1;
	for (size_t i = 0; i < cells && count < PAIRS; i += stride) {
		bool down = i / stride % 2;
		size_t next = down ? columns : 1;
		if (down ? i / columns + 2 >= rows : i % columns + 2 >= columns)
			continue;
		double one = angle_between(grid, i, i + next), two = angle_between(grid, i, i + 2 * next);
		if (!(one > 0.0 && two > 0.0))
			continue;
		even += fabs(two / one - 2.0) < UNEVEN;
		angle[count++] = (float)one;
	}
	if (count < POINTS_LEAST / 4 || (double)even < REGULAR * (double)count)
		return 0.0;
	return (double)gw_nth_element(angle, count, count / 2);
}

static bool is_usable(const gw_points *points, const gw_range_image *image)
{
	uint64_t cells = (uint64_t)image->columns * image->rows;
	bool finite = true;
	for (size_t k = 0; k < 3; k++)
		finite = finite && fabs(image->scanner[k]) <= GW_COORDINATE_MAX;
	return finite && image->first <= points->count &&
		   image->count <= points->count - image->first && image->count >= POINTS_LEAST &&
		   image->columns > 4 && image->rows > 4 && cells < UINT32_MAX &&
		   cells <= (uint64_t)CELLS_MOST * image->count;
}

bool gw_range_grid_open(const gw_points *points, const gw_range_image *image, gw_range_grid *grid)
{
	*grid = (gw_range_grid){ .points = points, .image = image };
	if (!is_usable(points, image))
		return true;
	grid->point = gw_allocate_array((size_t)image->columns * image->rows, sizeof *grid->point);
	if (!grid->point)
		return false;
	fill_cells(grid);
	grid->step = find_step(grid);
	return true;
}

void gw_range_grid_close(gw_range_grid *grid)
{
	free(grid->point);
	grid->point = NULL;
}
