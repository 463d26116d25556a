/*
 * range_thin.c - points of a range image that are things by themselves; see range_image.h.
 *
 * A wire or a leaf that is hardly wider than a cell is met by some beams and missed by those beside
 * them, which go on to something else. No plane through its neighbours in space is a surface then.
 * But each beam stands for its cell: so many beams as meet the thing, so many cells of directions
 * does it cover.
 */
#include "cloud/range_steps.h"

#include <math.h>
#include <stdlib.h>

#define THIN 2     /* cells in a row, at most, of what is thin */
#define LIKE 4.0   /* spacings by which ranges of neighbours on one thing differ at most */
#define NOISY 10.0 /* and standard deviations of their noise */
#define SMALL 1    /* half a window that holds what is two cells wide */
#define APART 4    /* cells between two by which the angle between neighbours is found */

static double length_of(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The cell some steps along a row or a column; SIZE_MAX beyond the image. */
static size_t cell_at(const gw_range_image *image, size_t cell, bool down, int steps)
{
	ptrdiff_t row = (ptrdiff_t)(cell / image->columns), column = (ptrdiff_t)(cell % image->columns);
	row += down ? steps : 0;
	column += down ? 0 : steps;
	if (row < 0 || column < 0 || row >= (ptrdiff_t)image->rows ||
		column >= (ptrdiff_t)image->columns)
		return SIZE_MAX;
	return (size_t)row * image->columns + (size_t)column;
}

/* Do the ranges of two cells, the first of which is `range` away, let them be of one thing? */
static bool are_like(const gw_range_grid *grid, double range, double other)
{
	double noise = (double)grid->noise[gw_range_bin(range)];
	return fabs(other - range) <= fmax(LIKE * grid->step * range, NOISY * noise);
}

/* Does a cell border on one of like range that a plane holds? Then it is on the rim of a surface.
 */
static bool is_on_rim(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell)
{
	double way[3];
	gw_range_way(grid, cell, way);
	double range = length_of(way);
	for (int i = 0; i < 9; i++) {
		size_t other = cell_at(grid->image, cell, true, i / 3 - 1);
		if (other != SIZE_MAX)
			other = cell_at(grid->image, other, false, i % 3 - 1);
		if (other != SIZE_MAX && gw_range_way(grid, other, way) &&
			plane[grid->point[other] - grid->image->first].half > SMALL &&
			are_like(grid, range, length_of(way)))
			return true;
	}
	return false;
}

/* How many cells in a row, up to one more than what is thin, are of one thing. */
static int run_length(const gw_range_grid *grid, size_t cell, bool down)
{
	int count = 1;
	for (int sign = -1; sign <= 1; sign += 2) {
		double way[3];
		gw_range_way(grid, cell, way);
		for (int i = 1; count <= THIN; i++) {
			double range = length_of(way);
			size_t next = cell_at(grid->image, cell, down, sign * i);
			if (next == SIZE_MAX || !gw_range_way(grid, next, way) ||
				!are_like(grid, range, length_of(way)))
				break;
			count++;
		}
	}
	return count;
}

/* The angle between neighbours around a cell, along its row or its column. */
static double angle_at(const gw_range_grid *grid, size_t cell, bool down)
{
	double v[3], w[3], across[3];
	gw_range_way(grid, cell, v);
	for (int i = 0; i < 2 * APART; i++) {
		int steps = (i % 2 ? -1 : 1) * (i / 2 + 1);
		size_t other = cell_at(grid->image, cell, down, steps);
		if (other == SIZE_MAX || !gw_range_way(grid, other, w))
			continue;
		for (size_t k = 0; k < 3; k++)
			across[k] = v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3];
		return atan2(length_of(across), v[0] * w[0] + v[1] * w[1] + v[2] * w[2]) / abs(steps);
	}
	return grid->step;
}

float gw_range_own_area(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell)
{
	double way[3];
	if (!gw_range_way(grid, cell, way) ||
		plane[grid->point[cell] - grid->image->first].half > SMALL)
		return 0.0f;
	if (is_on_rim(grid, plane, cell))
		return 0.0f;
	if (run_length(grid, cell, false) > THIN && run_length(grid, cell, true) > THIN)
		return 0.0f;
	double range = length_of(way);
	return (float)(range * range * angle_at(grid, cell, false) * angle_at(grid, cell, true));
}
