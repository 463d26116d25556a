/*
 * range_mixed.c - cells of a range image that belong to no surface; see range_image.h.
 *
 * What no plane holds is rough, or small, or no surface. A mixed pixel is the mean of what is
 * nearer and what is further off, and so lies between both.
 */
#include "cloud/range_steps.h"

#include <math.h>

#define GRAZING 0.1   /* cosine to the ray, below which a small plane may be a veil */
#define VEIL_REACH 3  /* cells from a mixed pixel to the surfaces beside it */
#define JUMP 4.0      /* spacings that these are nearer or further off at least */
#define HELD 5        /* of the eight cells around one that is alone, that are on planes */
#define OFF_PLANE 5.0 /* standard deviations that a mixed pixel is off their planes */

static double length_of(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Where surface is beside a cell, as its plane sees it. */
typedef struct side {
	bool known;
	double range;
	double expected; /* range of the plane there in the direction of the cell */
} side;

/* Cosine between a plane's normal and a way of some length. */
static double facing(const gw_range_plane *plane, const double way[3], double range)
{
	const double a[3] = { (double)plane->a[0], (double)plane->a[1], (double)plane->a[2] };
	return fabs(gw_range_plane_dot(plane, way)) / (length_of(a) * range);
}

static bool is_surface(const gw_range_plane *plane, const double way[3], double range)
{
	return plane->half > 2 || (plane->half > 0 && facing(plane, way, range) > GRAZING);
}

/* The nearest surface from a cell along a line of cells. */
static side look_aside(const gw_range_grid *grid, const gw_range_plane *plane, const size_t at[2],
					   const int step[2], const double direction[3])
{
	const gw_range_image *image = grid->image;
	for (int i = 1; i <= VEIL_REACH; i++) {
		ptrdiff_t row = (ptrdiff_t)at[0] + i * step[0], column = (ptrdiff_t)at[1] + i * step[1];
		double way[3];
		if (row < 0 || column < 0 || row >= (ptrdiff_t)image->rows ||
			column >= (ptrdiff_t)image->columns)
			break;
		size_t cell = (size_t)row * image->columns + (size_t)column;
		if (!gw_range_way(grid, cell, way))
			break;
		const gw_range_plane *there = &plane[grid->point[cell] - image->first];
		double range = length_of(way);
		if (is_surface(there, way, range))
			return (side){ true, range, 1.0 / gw_range_plane_dot(there, direction) };
	}
	return (side){ .known = false };
}

/* Is a cell that no plane holds between something nearer and something further off? */
static bool is_mixed(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell)
{
	static const int line[4][2] = { { 0, 1 }, { 1, 0 }, { 1, 1 }, { 1, -1 } };
	const size_t at[2] = { cell / grid->image->columns, cell % grid->image->columns };
	double way[3];
	gw_range_way(grid, cell, way);
	double range = length_of(way);
	if (is_surface(&plane[grid->point[cell] - grid->image->first], way, range))
		return false;
	double noise = (double)grid->noise[gw_range_bin(range)], spacing = grid->step * range;
	double jump = fmax(JUMP * spacing, 2.0 * OFF_PLANE * noise);
	double off = fmax(0.5 * spacing, OFF_PLANE * noise);
	for (size_t k = 0; k < 3; k++)
		way[k] /= range;
	for (int i = 0; i < 4; i++) {
		const int back[2] = { -line[i][0], -line[i][1] };
		side a = look_aside(grid, plane, at, line[i], way);
		side b = look_aside(grid, plane, at, back, way);
		if (!a.known || !b.known || fabs(a.expected - range) < off ||
			fabs(b.expected - range) < off)
			continue;
		if (fmin(a.range, b.range) < range - jump && fmax(a.range, b.range) > range + jump)
			return true;
	}
	return false;
}

/*
 * Is a cell alone in the midst of surface: none of the cells around has a like range, and most of
 * them are on planes? What is as small as one cell and hangs before a wall or behind a gap in it is
 * no part of any surface, however large a disc it would take to fill the cell.
 */
static bool is_alone(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell)
{
	const gw_range_image *image = grid->image;
	ptrdiff_t row = (ptrdiff_t)(cell / image->columns), column = (ptrdiff_t)(cell % image->columns);
	double way[3];
	int held = 0;
	gw_range_way(grid, cell, way);
	double range = length_of(way), noise = (double)grid->noise[gw_range_bin(range)];
	double like = fmax(JUMP * grid->step * range, 2.0 * OFF_PLANE * noise);
	if (plane[grid->point[cell] - image->first].half > 0)
		return false;
	for (int i = 0; i < 9; i++) {
		ptrdiff_t r = row + i / 3 - 1, c = column + i % 3 - 1;
		size_t other = (size_t)r * image->columns + (size_t)c;
		if (i == 4 || r < 0 || c < 0 || r >= (ptrdiff_t)image->rows ||
			c >= (ptrdiff_t)image->columns || !gw_range_way(grid, other, way))
			continue;
		if (fabs(length_of(way) - range) < like)
			return false;
		held += plane[grid->point[other] - image->first].half > 0;
	}
	return held >= HELD;
}

uint8_t gw_range_stray(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell)
{
	if (is_mixed(grid, plane, cell))
		return 1 + GW_STRAY_MIXED;
	return is_alone(grid, plane, cell) ? 1 + GW_STRAY_ALONE : 0;
}
