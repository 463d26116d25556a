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
#define ON 3.0     /* of these, and of FLAT, that what is on a plane is off it at most */
#define FLAT 0.02  /* of the spacing: what counts as noise in any case */
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

/* The angle between two ways. */
static double angle_between(const double v[3], const double w[3])
{
	double across[3];
	for (size_t k = 0; k < 3; k++)
		across[k] = v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3];
	return atan2(length_of(across), v[0] * w[0] + v[1] * w[1] + v[2] * w[2]);
}

/* A cell that has a point: the way there, and the plane that it is on. */
typedef struct place {
	size_t cell;
	double way[3], range;
	const gw_range_plane *plane;
} place;

/* False where the cell has no point. */
static bool find_place(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell,
					   place *found)
{
	if (cell == SIZE_MAX || !gw_range_way(grid, cell, found->way))
		return false;
	found->cell = cell;
	found->range = length_of(found->way);
	found->plane = &plane[grid->point[cell] - grid->image->first];
	return true;
}

/* Does a point lie on the plane of another one? Surface seen at a grazing angle goes on far beyond
 * its neighbours' range. */
static bool is_on_plane(const gw_range_grid *grid, const place *of, const place *at)
{
	if (of->plane->half == 0)
		return false;
	double noise =
		fmax((double)grid->noise[gw_range_bin(at->range)], FLAT * grid->step * at->range);
	return fabs(gw_range_plane_dot(of->plane, at->way) - 1.0) * at->range <= ON * noise;
}

/* May two points beside each other be of one thing: are their ranges alike, or is each on the
 * other's plane? */
static bool are_like(const gw_range_grid *grid, const place *one, const place *other)
{
	double noise = (double)grid->noise[gw_range_bin(one->range)];
	double most = fmax(LIKE * grid->step * one->range, NOISY * noise);
	return fabs(other->range - one->range) <= most ||
		   (is_on_plane(grid, one, other) && is_on_plane(grid, other, one));
}

/* Does a cell border on one of like range that a plane holds? Then it is on the rim of a surface.
 */
static bool is_on_rim(const gw_range_grid *grid, const gw_range_plane *plane, const place *at)
{
	for (int i = 0; i < 9; i++) {
		place other;
		size_t cell = cell_at(grid->image, at->cell, true, i / 3 - 1);
		if (cell != SIZE_MAX)
			cell = cell_at(grid->image, cell, false, i % 3 - 1);
		if (find_place(grid, plane, cell, &other) && other.plane->half > SMALL &&
			are_like(grid, at, &other))
			return true;
	}
	return false;
}

/* How many cells in a row, up to one more than what is thin, are of one thing. */
static int run_length(const gw_range_grid *grid, const gw_range_plane *plane, const place *at,
					  bool down)
{
	int count = 1;
	for (int sign = -1; sign <= 1; sign += 2) {
		place last = *at, next;
		for (int i = 1; count <= THIN; i++, last = next) {
			if (!find_place(grid, plane, cell_at(grid->image, at->cell, down, sign * i), &next) ||
				!are_like(grid, &last, &next))
				break;
			count++;
		}
	}
	return count;
}

/* The angle between neighbours around a cell, along its row or its column. */
static double angle_at(const gw_range_grid *grid, const place *at, bool down)
{
	double way[3];
	for (int i = 0; i < 2 * APART; i++) {
		int steps = (i % 2 ? -1 : 1) * (i / 2 + 1);
		size_t other = cell_at(grid->image, at->cell, down, steps);
		if (other != SIZE_MAX && gw_range_way(grid, other, way))
			return angle_between(at->way, way) / abs(steps);
	}
	return grid->step;
}

float gw_range_own_area(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell)
{
	place at;
	if (!find_place(grid, plane, cell, &at) || at.plane->half > SMALL ||
		is_on_rim(grid, plane, &at))
		return 0.0f;
	if (run_length(grid, plane, &at, false) > THIN && run_length(grid, plane, &at, true) > THIN)
		return 0.0f;
	return (float)(at.range * at.range * angle_at(grid, &at, false) * angle_at(grid, &at, true));
}
