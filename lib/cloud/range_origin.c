/*
 * range_origin.c - where the rays of a range image begin; see range_image.h.
 *
 * A scanner turns a mirror about one axis and its head about another, so that all rays of a column
 * lie in a plane through the head's axis, and all of a row on a cone around it; those of a camera's
 * columns and rows lie in planes through its pinhole. Noise is along the rays, and so are mixed
 * pixels and strays: none of them leaves these planes and cones. So planes are put through the
 * points of whole columns, or rows. All of a camera's meet in one point, those of a scanner in a
 * line, on which the place is found from which each row is seen at one elevation.
 *
 * What was found, or came with the file, is right if from there all columns and rows are circles on
 * the sphere of directions. Elsewhere they have a kink wherever the surface has one.
 */
#include "cloud/range_steps.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LINE_LEAST 8u       /* points of a row or column that says anything */
#define REGULAR 0.8         /* share of points that are on the circles of their row and column */
#define CIRCLE_OFF 0.5      /* cells that they may be off these */
#define COORDINATE_OFF 1e-3 /* metres by which coordinates may be rounded, besides */
#define TRIMS 3             /* rounds of fits without those that are far off */
#define TRIM 3.0            /* standard deviations that these are off */
#define RANK 1e-4           /* least share of a direction that planes say something of */
#define HEIGHTS 8           /* rounds of fits along the axis */
#define EXACT 0.02          /* cells off on the mean: no other place is looked for */
#define FAVOUR 0.8          /* of what another place may be off, to be better */

/* A row or a column. */
typedef struct cell_line {
	size_t first, stride, count;
} cell_line;

static cell_line line_of(const gw_range_image *image, bool column, size_t i)
{
	return column ? (cell_line){ i, image->columns, image->rows }
				  : (cell_line){ i * image->columns, 1, image->columns };
}

static size_t line_count(const gw_range_image *image, bool column)
{
	return column ? image->columns : image->rows;
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Eigenvalues of a symmetric matrix, the least first, and their axes, by Jacobi's rotations. */
static void find_eigen(double m[3][3], double value[3], double axis[3][3])
{
	for (int i = 0; i < 9; i++)
		axis[i / 3][i % 3] = i / 3 == i % 3;
	for (int round = 0; round < 30; round++) {
		int p = round % 3, q = (p + 1) % 3;
		double twice = 0.5 * atan2(2.0 * m[p][q], m[p][p] - m[q][q]);
		double c = cos(twice), s = sin(twice);
		for (int k = 0; k < 3; k++) {
			double x = m[k][p], y = m[k][q];
			m[k][p] = c * x + s * y;
			m[k][q] = c * y - s * x;
		}
		for (int k = 0; k < 3; k++) {
			double x = m[p][k], y = m[q][k], u = axis[p][k], v = axis[q][k];
			m[p][k] = c * x + s * y;
			m[q][k] = c * y - s * x;
			axis[p][k] = c * u + s * v;
			axis[q][k] = c * v - s * u;
		}
	}
	for (int k = 0; k < 3; k++)
		value[k] = m[k][k];
	for (int i = 0; i < 3; i++) {
		int a = i % 2, b = a + 1;
		double swapped[3], low = value[b];
		if (!(value[a] > low))
			continue;
		value[b] = value[a];
		value[a] = low;
		memcpy(swapped, axis[a], sizeof swapped);
		memcpy(axis[a], axis[b], sizeof swapped);
		memcpy(axis[b], swapped, sizeof swapped);
	}
}

/* ----------------------------------------------------------------------------- planes of lines */

/* A plane through the points of a line, or through their directions: normal . v is offset. */
typedef struct line_plane {
	double count, normal[3], offset;
	double deviation; /* of the points from it */
	double inertia;   /* of the points, in it, about the direction in which they extend */
} line_plane;

/* The way of a cell, or its direction. False when it has none or is further off a plane than
 * `most`. */
static bool take_way(const gw_range_grid *grid, size_t cell, bool direction,
					 const line_plane *plane, double v[3])
{
	if (!gw_range_way(grid, cell, v))
		return false;
	double length = direction ? sqrt(dot(v, v)) : 1.0;
	for (size_t k = 0; k < 3; k++)
		v[k] /= length;
	return plane->count == 0.0 ||
		   fabs(dot(plane->normal, v) - plane->offset) <= TRIM * plane->deviation;
}

static line_plane fit_once(const gw_range_grid *grid, const cell_line *line, bool direction,
						   const line_plane *before)
{
	double sum[3] = { 0 }, m[3][3] = { { 0 } }, v[3], value[3], axis[3][3];
	line_plane plane = { .count = 0.0 };
	for (size_t i = 0; i < line->count; i++) {
		if (!take_way(grid, line->first + i * line->stride, direction, before, v))
			continue;
		plane.count++;
		for (int r = 0; r < 3; r++) {
			sum[r] += v[r];
			for (int c = 0; c < 3; c++)
				m[r][c] += v[r] * v[c];
		}
	}
	if (plane.count < LINE_LEAST)
		return (line_plane){ .count = 0.0 };
	for (int i = 0; i < 9; i++)
		m[i / 3][i % 3] -= sum[i / 3] * sum[i % 3] / plane.count;
	find_eigen(m, value, axis);
	memcpy(plane.normal, axis[0], sizeof plane.normal);
	plane.offset = dot(axis[0], sum) / plane.count;
	plane.deviation = sqrt(fmax(value[0], 0.0) / plane.count);
	plane.inertia = fmax(value[1], 0.0);
	return plane;
}

static line_plane fit_line(const gw_range_grid *grid, const cell_line *line, bool direction)
{
	line_plane plane = { .count = 0.0 };
	for (int i = 0; i < TRIMS; i++)
		plane = fit_once(grid, line, direction, &plane);
	return plane;
}

/* ------------------------------------------------------------------------------------ check */

/* How well rows and columns are seen as circles. */
typedef struct regularity {
	double share; /* of the points that are on them */
	double off;   /* mean of how far they are off, cells; far off counts as one */
} regularity;

/* Of all rows, or all columns. */
static regularity regularity_of(const gw_range_grid *grid, bool columns)
{
	const line_plane all = { .count = 0.0 };
	double count = 0.0, on = 0.0, sum = 0.0;
	for (size_t i = 0; i < line_count(grid->image, columns); i++) {
		cell_line line = line_of(grid->image, columns, i);
		line_plane circle = fit_line(grid, &line, true);
		double v[3];
		for (size_t k = 0; k < line.count && circle.count > 0.0; k++) {
			size_t cell = line.first + k * line.stride;
			if (!take_way(grid, cell, true, &all, v))
				continue;
			double off = fabs(dot(circle.normal, v) - circle.offset);
			gw_range_way(grid, cell, v);
			on += off < CIRCLE_OFF * grid->step + COORDINATE_OFF / sqrt(dot(v, v));
			sum += fmin(off / grid->step, 1.0);
			count++;
		}
	}
	return count > 0.0 ? (regularity){ on / count, sum / count } : (regularity){ 0.0, 1.0 };
}

/* The worse of rows and columns; nothing for grids of which the angles are uneven. */
static regularity find_regularity(const gw_range_grid *grid)
{
	if (!(grid->step > 0.0))
		return (regularity){ 0.0, 1.0 };
	regularity columns = regularity_of(grid, true), rows = regularity_of(grid, false);
	return (regularity){ fmin(columns.share, rows.share), fmax(columns.off, rows.off) };
}

bool gw_range_rays_meet(const gw_range_grid *grid)
{
	return find_regularity(grid).share >= REGULAR;
}

/* ----------------------------------------------------------------------------------- search */

/* Normal equations of the place that lies in many planes. */
typedef struct meeting {
	double m[3][3], b[3];
} meeting;

/* How well a plane is known a distance away that is as large as the image's points extend. */
static double weight_of(const line_plane *plane, double extent)
{
	return plane->inertia > 0.0 ? 1.0 / (1.0 / plane->count + extent * extent / plane->inertia)
								: 0.0;
}

static void add_planes(const gw_range_grid *grid, bool columns, double extent, meeting *to)
{
	for (size_t i = 0; i < line_count(grid->image, columns); i++) {
		cell_line line = line_of(grid->image, columns, i);
		line_plane plane = fit_line(grid, &line, false);
		double weight = plane.count > 0.0 ? weight_of(&plane, extent) : 0.0;
		for (int r = 0; r < 3; r++) {
			to->b[r] += weight * plane.normal[r] * plane.offset;
			for (int c = 0; c < 3; c++)
				to->m[r][c] += weight * plane.normal[r] * plane.normal[c];
		}
	}
}

/* The place in all planes, or, of a scanner, the one on their line that is nearest to the origin;
 * false when they say less. `axis` receives the direction of that line. */
static bool solve(const meeting *from, bool scanner, double place[3], double axis[3])
{
	double m[3][3], value[3], axes[3][3];
	memcpy(m, from->m, sizeof m);
	find_eigen(m, value, axes);
	memcpy(axis, axes[0], 3 * sizeof *axis);
	memset(place, 0, 3 * sizeof *place);
	if (!(value[scanner ? 1 : 0] > RANK * value[2]))
		return false;
	for (int i = scanner ? 1 : 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			place[k] += dot(axes[i], from->b) / value[i] * axes[i][k];
	return true;
}

/*
 * The height along the axis from which each line is seen at one elevation: with the distance d from
 * the axis and the height h, h / d = slope + height / d, of which all lines have a slope of their
 * own and one height in common. `height` is what it is taken to be, for the weights.
 */
static double find_height(const gw_range_grid *grid, bool columns, const double place[3],
						  const double axis[3], double height)
{
	double products = 0.0, squares = 0.0;
	for (size_t i = 0; i < line_count(grid->image, columns); i++) {
		cell_line line = line_of(grid->image, columns, i);
		double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, v[3];
		for (size_t k = 0; k < line.count; k++) {
			if (!gw_range_way(grid, line.first + k * line.stride, v))
				continue;
			for (size_t c = 0; c < 3; c++)
				v[c] -= place[c];
			double up = dot(v, axis), square = fmax(dot(v, v) - up * up, 1e-12);
			double whole = square + (up - height) * (up - height), flat = sqrt(square);
			double weight = square / whole * (square / whole); /* of a slope by its angle */
			n += weight;
			x += weight / flat;
			xx += weight / square;
			y += weight * up / flat;
			xy += weight * up / square;
		}
		products += n > 0.0 ? xy - x * y / n : 0.0;
		squares += n > 0.0 ? xx - x * x / n : 0.0;
	}
	return squares > 0.0 ? products / squares : height;
}

/* A scanner of which the columns, or else the rows, are planes. */
static bool find_scanner(const gw_range_grid *grid, const meeting *planes, bool columns,
						 double place[3])
{
	double axis[3], height = 0.0;
	if (!solve(planes, true, place, axis))
		return false;
	for (int i = 0; i < HEIGHTS; i++)
		height = find_height(grid, !columns, place, axis, height);
	for (size_t k = 0; k < 3; k++)
		place[k] += height * axis[k];
	return true;
}

/* How far the points of a grid extend. */
static double extent_of(const gw_range_grid *grid)
{
	size_t cells = (size_t)grid->image->columns * grid->image->rows;
	double v[3], sum[3] = { 0 }, squares = 0.0, count = 0.0;
	for (size_t i = 0; i < cells; i++) {
		if (!gw_range_way(grid, i, v))
			continue;
		count++;
		squares += dot(v, v);
		for (size_t k = 0; k < 3; k++)
			sum[k] += v[k];
	}
	return count > 0.0 ? sqrt(fmax(squares - dot(sum, sum) / count, 0.0) / count) : 0.0;
}

/* A place that rays may begin at. */
typedef struct candidate {
	double place[3];
	regularity seen; /* from there */
} candidate;

/* Takes a place, from the image's scanner, if it is better than what was found before. */
static void take_better(const gw_points *points, const gw_range_image *image, const double place[3],
						candidate *best)
{
	gw_range_image there = *image;
	gw_range_grid grid;
	for (size_t k = 0; k < 3; k++)
		there.scanner[k] += place[k];
	gw_range_grid_open(points, &there, &grid);
	regularity seen = find_regularity(&grid);
	if (seen.share >= REGULAR && seen.off < best->seen.off) {
		best->seen = seen;
		memcpy(best->place, there.scanner, sizeof best->place);
	}
	gw_range_grid_close(&grid);
}

/* `grid` is as seen from one of its points. */
static void search(const gw_range_grid *grid, candidate *best)
{
	meeting columns = { .b = { 0 } }, rows = { .b = { 0 } }, both;
	double place[3], axis[3], extent = extent_of(grid);
	add_planes(grid, true, extent, &columns);
	add_planes(grid, false, extent, &rows);
	both = columns;
	for (int i = 0; i < 9; i++)
		both.m[i / 3][i % 3] += rows.m[i / 3][i % 3];
	for (int i = 0; i < 3; i++)
		both.b[i] += rows.b[i];
	if (find_scanner(grid, &columns, true, place))
		take_better(grid->points, grid->image, place, best);
	if (find_scanner(grid, &rows, false, place))
		take_better(grid->points, grid->image, place, best);
	if (solve(&both, false, place, axis))
		take_better(grid->points, grid->image, place, best);
}

/* A place beside the points, so that numbers stay small: the first that is one. */
static void take_first_point(const gw_range_grid *grid, double place[3])
{
	size_t cell = 0;
	while (grid->point[cell] == GW_NO_POINT)
		cell++;
	memcpy(place, grid->points->position + 3 * (size_t)grid->point[cell], 3 * sizeof *place);
}

bool gw_range_image_find_scanner(const gw_points *points, const gw_range_image *image,
								 double scanner[3])
{
	static const double here[3] = { 0.0, 0.0, 0.0 };
	gw_range_grid grid;
	gw_range_image there = *image;
	candidate best = { .seen = { 0.0, 1.0 } };
	bool usable = gw_range_grid_open(points, image, &grid) && grid.point;
	take_better(points, image, here, &best);
	if (usable)
		take_first_point(&grid, there.scanner);
	gw_range_grid_close(&grid);
	/* What the image says has the benefit of the doubt. */
	bool sure = best.seen.off < EXACT;
	best.seen.off *= FAVOUR;
	if (usable && !sure && gw_range_grid_open(points, &there, &grid) && grid.point)
		search(&grid, &best);
	if (usable && !sure)
		gw_range_grid_close(&grid);
	if (best.seen.share >= REGULAR)
		memcpy(scanner, best.place, sizeof best.place);
	return best.seen.share >= REGULAR;
}
