/*
 * range_blend.c - one surface from the planes of a range image's windows; see range_image.h.
 *
 * Each point has the plane of a window of its own. Those of neighbours may be as far apart as the
 * noise is large, where one window is larger than the next: steps that shade each other. So each
 * point gets the mean of all planes in whose windows it lies, weighted by their cells, which
 * changes from cell to cell no more than one more window in some hundred does. This is the second
 * step of a guided filter (He et al. 2013), with windows of many sizes. They are added up as in a
 * table of sums: each at its four corners, a few rows at a time.
 */
#include "cloud/range_steps.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TERMS 4u /* the weight, and that times the three numbers of a plane */
#define AHEAD 25 /* rows that windows reach to beyond their cell: one beside it is twice as far */
#define RING 64u /* rows kept; windows begin and end within twice AHEAD */
#define OWN 5.0  /* standard deviations of noise that a point may be off the mean plane */

/* Spacings of noise: steps that are small beside the spacing shade nothing, and windows of their
 * own show more of the surface. */
#define BLEND_FROM 0.25
#define BLEND_ALL 0.5

/* Sums over the rows that are being made. */
typedef struct blend {
	const gw_range_grid *grid;
	gw_range_plane *plane;
	double *corner; /* RING rows of columns + 1 times TERMS: changes from cell to cell */
	double *line;   /* columns + 1 times TERMS: the same, summed over all rows so far */
} blend;

static ptrdiff_t within(ptrdiff_t at, ptrdiff_t most)
{
	return at < 0 ? 0 : at > most ? most : at;
}

static double *corner_at(const blend *b, ptrdiff_t row, ptrdiff_t column)
{
	size_t width = (size_t)b->grid->image->columns + 1;
	return b->corner + ((size_t)row % RING * width + (size_t)column) * TERMS;
}

/* Adds the window of a cell's plane. */
static void add_window(const blend *b, ptrdiff_t row, ptrdiff_t column, const gw_range_plane *plane)
{
	ptrdiff_t half = plane->half, rows = b->grid->image->rows, columns = b->grid->image->columns;
	ptrdiff_t middle_row = row + plane->aside[0] * half;
	ptrdiff_t middle_column = column + plane->aside[1] * half;
	const ptrdiff_t r[2] = { within(middle_row - half, rows), within(middle_row + half + 1, rows) };
	const ptrdiff_t c[2] = { within(middle_column - half, columns),
							 within(middle_column + half + 1, columns) };
	double weight = (2.0 * (double)half + 1.0) * (2.0 * (double)half + 1.0);
	const double term[TERMS] = { weight, weight * (double)plane->a[0], weight * (double)plane->a[1],
								 weight * (double)plane->a[2] };
	for (size_t i = 0; i < 4; i++) {
		double *to = corner_at(b, r[i / 2], c[i % 2]), sign = i / 2 == i % 2 ? 1.0 : -1.0;
		for (size_t k = 0; k < TERMS; k++)
			to[k] += sign * term[k];
	}
}

static void add_row(const blend *b, size_t row)
{
	const gw_range_image *image = b->grid->image;
	for (size_t column = 0; row < image->rows && column < image->columns; column++) {
		uint32_t point = b->grid->point[row * image->columns + column];
		if (point != GW_NO_POINT && b->plane[point - image->first].half > 0)
			add_window(b, (ptrdiff_t)row, (ptrdiff_t)column, &b->plane[point - image->first]);
	}
}

/* How much of the mean is taken where noise is so many spacings. */
static double share_of(double spread)
{
	return fmin(fmax((spread - BLEND_FROM) / (BLEND_ALL - BLEND_FROM), 0.0), 1.0);
}

/* Takes the mean plane for a cell, if that has its point on it. */
static void take_mean(const blend *b, size_t cell, const double sum[TERMS])
{
	double way[3];
	if (!gw_range_way(b->grid, cell, way) || !(sum[0] > 0.5))
		return;
	gw_range_plane *own = &b->plane[b->grid->point[cell] - b->grid->image->first], mean = *own;
	for (size_t k = 0; k < 3; k++)
		mean.a[k] = (float)(sum[1 + k] / sum[0]);
	double range = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
	double noise = (double)b->grid->noise[gw_range_bin(range)];
	float share = (float)share_of(noise / (b->grid->step * range));
	/* The product is the range over that to the plane. */
	bool holds = fabs(gw_range_plane_dot(&mean, way) - 1.0) * range <= OWN * noise;
	for (size_t k = 0; k < 3 && own->half > 0 && holds; k++)
		own->a[k] += share * (mean.a[k] - own->a[k]);
}

/* Finishes a row: all windows that begin there have been added. */
static void finish_row(const blend *b, size_t row)
{
	size_t columns = b->grid->image->columns;
	double *corner = corner_at(b, (ptrdiff_t)row, 0), sum[TERMS] = { 0 };
	for (size_t i = 0; i < (columns + 1) * TERMS; i++)
		b->line[i] += corner[i];
	memset(corner, 0, (columns + 1) * TERMS * sizeof *corner);
	for (size_t column = 0; column < columns; column++) {
		for (size_t k = 0; k < TERMS; k++)
			sum[k] += b->line[column * TERMS + k];
		take_mean(b, row * columns + column, sum);
	}
}

bool gw_range_planes_blend(const gw_range_grid *grid, gw_range_plane *plane)
{
	size_t rows = grid->image->rows, width = (size_t)grid->image->columns + 1;
	blend b = { .grid = grid, .plane = plane };
	b.corner = gw_allocate_zeros(RING * width, TERMS * sizeof *b.corner);
	b.line = gw_allocate_zeros(width, TERMS * sizeof *b.line);
	bool good = b.corner && b.line;
	for (size_t row = 0; good && row < rows + AHEAD; row++) {
		add_row(&b, row);
		if (row >= AHEAD)
			finish_row(&b, row - AHEAD);
	}
	free(b.corner);
	free(b.line);
	return good;
}
