/* stray_mounts.c - see stray_mounts.h. */
#include "cloud/stray_mounts.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "base/up_axis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SCANNERS_MOST 64

/* What is near: metres, and of the median range. Plates and heads of tripods reach 0.3 m, robots
 * 0.9; floors and walls begin at half the median of a room at least. */
#define NEAR 1.0
#define NEAR_SHARE 0.4

/* Cells of directions, as cubes that the sphere around the scanner goes through: as wide as 4.6
 * degrees, which is about 2000 of them. Fewer points would leave many without one. */
#define CELL 0.08
#define ROW 26 /* of 2 / CELL */
#define CELLS ((size_t)ROW * ROW * ROW)
#define POINTS_LEAST 10000

/* Surface goes on into a cell with points that are no further off than that, of what is near.
 * Floors and walls go on at all of their border, the robot of a real scan at a quarter. */
#define GOES_ON 1.5
#define GOING_ON_MOST 0.5

/* It has to lie on all sides of its middle, in as many sectors, between these angles' cosines: 10
 * and 50 degrees. Posts do not. */
#define SECTORS 12
#define INNER 0.985
#define OUTER 0.643

/* A bracket may be beside the scanner: metres. What is further off and carries it is beneath, or
 * above where it hangs, by this cosine: 45 degrees. The robot's is 1.00, the jamb of a door in
 * which a scanner stood 0.3 to 0.4. */
#define PLATE 0.3
#define STEEP 0.707

#define PI 3.14159265358979323846

/* Points of one scanner in one direction. */
typedef struct direction {
	uint32_t points, near;
	float least;   /* range of those that are not near */
	float nearest; /* range of the nearest one */
	bool taken;
} direction;

/* One scanner's. */
typedef struct mount_search {
	const gw_points *points;
	size_t scanner;
	double limit;
	direction *cell; /* CELLS */
	uint32_t *part;  /* part_count cells that touch, in which points are near */
	size_t part_count;
	size_t border, going_on; /* cells around the part, and those into which it goes on */
} mount_search;

static size_t scanner_of(const gw_points *points, size_t i)
{
	size_t of = points->scanner_of ? points->scanner_of[i] : 0;
	return points->scanner_of || points->scanner_count == 1 ? of : points->scanner_count;
}

/* NaN where the point or the scanner is nowhere. */
static double range_of(const gw_points *points, size_t scanner, size_t i, double way[3])
{
	double square = 0.0;
	for (size_t k = 0; k < 3; k++) {
		way[k] = points->position[3 * i + k] - points->scanner[3 * scanner + k];
		square += way[k] * way[k];
	}
	return isfinite(square) ? sqrt(square) : NAN;
}

/* What counts as near; false where too little is known of the scanner. */
static bool find_limit(mount_search *m, float *range)
{
	size_t count = 0;
	double way[3];
	for (size_t i = 0; i < m->points->count; i++) {
		if (scanner_of(m->points, i) != m->scanner)
			continue;
		double value = range_of(m->points, m->scanner, i, way);
		if (!isnan(value))
			range[count++] = (float)value;
	}
	if (count < POINTS_LEAST)
		return false;
	m->limit = fmin(NEAR, NEAR_SHARE * (double)gw_nth_element(range, count, count / 2));
	return m->limit > 0.0;
}

static size_t cell_of(const double way[3], double range)
{
	size_t cell = 0;
	for (int k = 0; k < 3; k++) {
		double along = range > 0.0 ? way[k] / range : 0.0;
		cell = ROW * cell + (size_t)fmin(fmax((along + 1.0) / CELL, 0.0), ROW - 1);
	}
	return cell;
}

static void fill_cells(mount_search *m)
{
	memset(m->cell, 0, CELLS * sizeof *m->cell);
	for (size_t i = 0; i < m->points->count; i++) {
		double way[3], range = range_of(m->points, m->scanner, i, way);
		if (scanner_of(m->points, i) != m->scanner || isnan(range))
			continue;
		direction *d = m->cell + cell_of(way, range);
		bool near = range < m->limit;
		d->nearest = d->points == 0 ? (float)range : fminf(d->nearest, (float)range);
		if (!near)
			d->least = d->points == d->near ? (float)range : fminf(d->least, (float)range);
		d->points++;
		d->near += near;
	}
}

static bool is_near(const direction *d)
{
	return d->points > 0 && 2 * d->near > d->points;
}

/* The cell beside one, of the 27 with itself; CELLS where there is none. */
static size_t beside(size_t cell, int which)
{
	int place[3] = { (int)(cell / (ROW * ROW)), (int)(cell / ROW % ROW), (int)(cell % ROW) };
	size_t other = 0;
	for (int k = 0; k < 3; k++, which /= 3) {
		place[k] += which % 3 - 1;
		if (place[k] < 0 || place[k] >= ROW)
			return CELLS;
		other = ROW * other + (size_t)place[k];
	}
	return other;
}

/* Takes the cells that hang together with one, and counts those around. A cell of the border may be
 * beside several: it counts with each. */
static void take_part(mount_search *m, size_t first)
{
	m->part_count = m->border = m->going_on = 0;
	m->part[m->part_count++] = (uint32_t)first;
	m->cell[first].taken = true;
	for (size_t p = 0; p < m->part_count; p++)
		for (int which = 0; which < 27; which++) {
			size_t other = beside(m->part[p], which);
			direction *d = other < CELLS ? m->cell + other : NULL;
			if (d && is_near(d) && !d->taken) {
				d->taken = true;
				m->part[m->part_count++] = (uint32_t)other;
			} else if (d && d->points > 0 && !is_near(d)) {
				m->border++;
				m->going_on += (double)d->least < GOES_ON * m->limit;
			}
		}
}

static void way_of(size_t cell, double way[3])
{
	const size_t place[3] = { cell / (ROW * ROW), cell / ROW % ROW, cell % ROW };
	for (int k = 0; k < 3; k++)
		way[k] = ((double)place[k] + 0.5) * CELL - 1.0;
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Does the part lie on all sides of its middle? */
static bool is_around(const mount_search *m)
{
	double middle[3] = { 0 }, way[3], side[3];
	bool found[SECTORS] = { false };
	for (size_t p = 0; p < m->part_count; p++) {
		way_of(m->part[p], way);
		for (int k = 0; k < 3; k++)
			middle[k] += way[k];
	}
	double length = sqrt(dot(middle, middle));
	if (!(length > 0.0))
		return false;
	for (int k = 0; k < 3; k++)
		middle[k] /= length;
	/* Any two directions across it. */
	int least = fabs(middle[0]) < 0.6 ? 0 : 1;
	for (int k = 0; k < 3; k++)
		side[k] = (k == least) - middle[least] * middle[k];
	double size = sqrt(dot(side, side));
	for (size_t p = 0; p < m->part_count; p++) {
		way_of(m->part[p], way);
		double along = dot(way, middle) / sqrt(dot(way, way));
		const double up[3] = { middle[1] * side[2] - middle[2] * side[1],
							   middle[2] * side[0] - middle[0] * side[2],
							   middle[0] * side[1] - middle[1] * side[0] };
		double turn = (atan2(dot(way, up), dot(way, side)) / (2.0 * PI) + 0.5) * SECTORS;
		if (along < INNER && along > OUTER)
			found[(int)turn % SECTORS] = true;
	}
	bool all = size > 0.0;
	for (int s = 0; s < SECTORS; s++)
		all = all && found[s];
	return all;
}

/* Is the part where things are that carry a scanner: beneath or above it rather than beside, or
 * within reach of its own plate? */
static bool may_carry(const mount_search *m)
{
	double middle[3] = { 0 }, up[3], range = 0.0;
	for (size_t p = 0; p < m->part_count; p++) {
		double way[3];
		way_of(m->part[p], way);
		double length = sqrt(dot(way, way));
		for (int k = 0; k < 3; k++)
			middle[k] += way[k] / length;
		range += (double)m->cell[m->part[p]].nearest / (double)m->part_count;
	}
	gw_up_axis(m->points->up, up);
	return range < PLATE || fabs(dot(up, middle)) > STEEP * sqrt(dot(middle, middle));
}

/* Leaves the cells of mounts taken, and no others. */
static bool find_mounts(mount_search *m)
{
	bool any = false;
	for (size_t cell = 0; cell < CELLS; cell++) {
		if (!is_near(m->cell + cell) || m->cell[cell].taken)
			continue;
		take_part(m, cell);
		bool alone = (double)m->going_on < GOING_ON_MOST * (double)m->border;
		bool mount = alone && is_around(m) && may_carry(m);
		any = any || mount;
		for (size_t p = 0; p < m->part_count && !mount; p++)
			m->cell[m->part[p]].near = 0;
	}
	return any;
}

/* At its rim, cells have more of what is behind it. */
static bool is_of_mount(const mount_search *m, size_t cell)
{
	bool found = false;
	for (int which = 0; which < 27 && !found; which++) {
		size_t other = beside(cell, which);
		found = other < CELLS && is_near(m->cell + other);
	}
	return found;
}

static void mark(const mount_search *m, uint8_t *found)
{
	for (size_t i = 0; i < m->points->count; i++) {
		double way[3], range = range_of(m->points, m->scanner, i, way);
		if (scanner_of(m->points, i) == m->scanner && range < m->limit)
			found[i] = is_of_mount(m, cell_of(way, range));
	}
}

/* Which scanners have points within reach: most have none. */
static bool find_near(const gw_points *points, bool near[SCANNERS_MOST])
{
	bool any = false;
	double way[3];
	for (size_t i = 0; i < points->count; i++) {
		size_t scanner = scanner_of(points, i);
		if (scanner >= points->scanner_count || near[scanner] ||
			!(range_of(points, scanner, i, way) < NEAR))
			continue;
		near[scanner] = any = true;
	}
	return any;
}

gw_status gw_stray_mounts_find(const gw_points *points, uint8_t **found, gw_error *error)
{
	bool near[SCANNERS_MOST] = { false }, any = false;
	*found = NULL;
	if (points->scanner_count > SCANNERS_MOST || !find_near(points, near))
		return GW_OK;
	mount_search m = { .points = points,
					   .cell = gw_allocate_array(CELLS, sizeof *m.cell),
					   .part = gw_allocate_array(CELLS, sizeof *m.part) };
	float *range = gw_allocate_array(points->count, sizeof *range);
	*found = gw_allocate_zeros(points->count, 1);
	bool room = m.cell && m.part && range && *found;
	for (; room && m.scanner < points->scanner_count; m.scanner++) {
		if (!near[m.scanner] || !find_limit(&m, range))
			continue;
		fill_cells(&m);
		if (find_mounts(&m)) {
			mark(&m, *found);
			any = true;
		}
	}
	free(m.cell);
	free(m.part);
	free(range);
	if (!room || !any) {
		free(*found);
		*found = NULL;
	}
	return room ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY,
						  "no memory to look around scanners among %zu points", points->count);
}
