/*
 * range_plane.c - the plane that each point of a range image is on; see range_image.h.
 *
 * With d the direction of a cell and u the inverse of its range, a plane is u = a . d, and the
 * least squares of a window need but the sums of d d, d u, u u. Those of any window are four
 * corners of sums over all that is above and to the left, which are made for one tile of the image
 * at a time.
 */
#include "cloud/range_steps.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define TILE 64u
#define HALF_MOST 12u
#define HALO (2u * HALF_MOST) /* a window beside a cell reaches as far */
#define WIDTH (TILE + 2u * HALO + 1u)
#define SUMS 11u  /* count, six of d d, three of d u, and u u */
#define FULL 0.6  /* share of a window's cells that have to have a point */
#define SURE 2.5  /* standard deviations by which a residual may exceed the noise */
#define OWN 3.0   /* of noise that the point itself may be off its plane */
#define FLAT 0.02 /* of the spacing: what counts as noise in any case */

static const uint8_t halves[] = { 12, 8, 5, 3, 2, 1 };

typedef struct plane_job {
	const gw_range_grid *grid;
	gw_range_plane *plane;
	double **sums; /* of each worker */
	size_t tiles_across;
} plane_job;

/* Where the tile's sums begin. */
typedef struct tile {
	ptrdiff_t column, row; /* of its first cell, the halo included */
	const double *sums;    /* WIDTH * WIDTH * SUMS */
} tile;

/* Fills the sums of a tile: entry (r, c) is over all cells above r and left of c. */
static void sum_tile(const gw_range_grid *grid, tile *t, double *sums)
{
	ptrdiff_t columns = grid->image->columns, rows = grid->image->rows;
	memset(sums, 0, WIDTH * SUMS * sizeof *sums);
	t->sums = sums;
	for (size_t r = 1; r < WIDTH; r++) {
		double line[SUMS] = { 0 }, *to = sums + r * WIDTH * SUMS;
		const double *above = to - WIDTH * SUMS;
		memset(to, 0, SUMS * sizeof *to);
		for (size_t c = 1; c < WIDTH; c++) {
			ptrdiff_t row = t->row + (ptrdiff_t)r - 1, column = t->column + (ptrdiff_t)c - 1;
			double d[3];
			to += SUMS;
			above += SUMS;
			if (row >= 0 && row < rows && column >= 0 && column < columns &&
				gw_range_way(grid, (size_t)(row * columns + column), d)) {
				double u = 1.0 / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
				for (size_t k = 0; k < 3; k++)
					d[k] *= u;
				const double term[SUMS] = { 1,           d[0] * d[0], d[1] * d[1], d[2] * d[2],
											d[0] * d[1], d[0] * d[2], d[1] * d[2], d[0] * u,
											d[1] * u,    d[2] * u,    u * u };
				for (size_t k = 0; k < SUMS; k++)
					line[k] += term[k];
			}
			for (size_t k = 0; k < SUMS; k++)
				to[k] = above[k] + line[k];
		}
	}
}

/* Sums of the window of which the middle is (row, column) of the tile. */
static void window_sums(const tile *t, ptrdiff_t row, ptrdiff_t column, ptrdiff_t half,
						double out[SUMS])
{
	const double *low = t->sums + ((size_t)(row - half) * WIDTH + (size_t)(column - half)) * SUMS;
	const double *high =
		t->sums + ((size_t)(row + half + 1) * WIDTH + (size_t)(column - half)) * SUMS;
	size_t across = (size_t)(2 * half + 1) * SUMS;
	for (size_t k = 0; k < SUMS; k++)
		out[k] = high[across + k] - high[k] - low[across + k] + low[k];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Two unit vectors at right angles to a unit vector and to each other (Duff et al. 2017). */
static void make_axes(const double n[3], double u[3], double v[3])
{
	double sign = copysign(1.0, n[2]), a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
	const double first[3] = { 1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0] };
	const double second[3] = { b, sign + n[1] * n[1] * a, -n[1] };
	memcpy(u, first, sizeof first);
	memcpy(v, second, sizeof second);
}

/* Symmetric product x . (sum of d d) . y. */
static double product(const double s[SUMS], const double x[3], const double y[3])
{
	const double row[3] = { s[1] * y[0] + s[4] * y[1] + s[5] * y[2],
							s[4] * y[0] + s[2] * y[1] + s[6] * y[2],
							s[5] * y[0] + s[6] * y[1] + s[3] * y[2] };
	return dot(x, row);
}

/*
 * The plane of a window by least squares. In axes of which the first is the cell's direction, the
 * sums are near to n 0 0, 0 e 0, 0 0 e with small e; taking the first unknown out leaves two by two
 * numbers that are well known. Returns the standard deviation of u, or NAN.
 */
static double fit(const double s[SUMS], const double axis[3][3], double a[3])
{
	const double *du = s + 7;
	double m[3][3], b[3], x[3];
	for (int i = 0; i < 3; i++) {
		b[i] = dot(axis[i], du);
		for (int k = 0; k < 3; k++)
			m[i][k] = product(s, axis[i], axis[k]);
	}
	double p = m[1][1] - m[0][1] * m[0][1] / m[0][0], q = m[1][2] - m[0][1] * m[0][2] / m[0][0];
	double r = m[2][2] - m[0][2] * m[0][2] / m[0][0], determinant = p * r - q * q;
	if (!(determinant > 1e-3 * (p + r) * (p + r)) || !(p + r > 1e-11 * m[0][0]))
		return NAN;
	double e = b[1] - m[0][1] * b[0] / m[0][0], f = b[2] - m[0][2] * b[0] / m[0][0];
	x[1] = (r * e - q * f) / determinant;
	x[2] = (p * f - q * e) / determinant;
	x[0] = (b[0] - m[0][1] * x[1] - m[0][2] * x[2]) / m[0][0];
	for (size_t k = 0; k < 3; k++)
		a[k] = x[0] * axis[0][k] + x[1] * axis[1][k] + x[2] * axis[2][k];
	double rest = s[10] - dot(a, du);
	return sqrt(fmax(rest, 0.0) / fmax(s[0] - 3.0, 1.0));
}

/* What a cell is held against. */
typedef struct cell_view {
	double axis[3][3]; /* the first is its direction */
	double inverse;    /* of its range */
	double noise;      /* of that */
} cell_view;

/* Tries a window; returns how far the cell's u is off it, in standard deviations, or infinity. */
static double try_window(const tile *t, const cell_view *v, const ptrdiff_t at[2], ptrdiff_t half,
						 double a[3])
{
	double s[SUMS];
	window_sums(t, at[0], at[1], half, s);
	double cells = (double)((2 * half + 1) * (2 * half + 1));
	if (s[0] < fmax(6.0, FULL * cells))
		return INFINITY;
	double deviation = fit(s, v->axis, a);
	double most = v->noise * (1.0 + SURE / sqrt(2.0 * (s[0] - 3.0)));
	if (!(deviation <= most))
		return INFINITY;
	return fabs(dot(a, v->axis[0]) - v->inverse) / v->noise;
}

static void take_window(const double a[3], uint8_t half, int place, gw_range_plane *plane)
{
	*plane = (gw_range_plane){ { (float)a[0], (float)a[1], (float)a[2] },
							   half,
							   { (int8_t)(place / 3 - 1), (int8_t)(place % 3 - 1) } };
}

/* Of a size, the window around the cell, or else the best of those beside it. */
static bool try_size(const tile *t, const cell_view *v, const ptrdiff_t at[2], uint8_t half,
					 bool beside, gw_range_plane *best)
{
	double a[3], off = OWN;
	if (!beside) {
		if (!(try_window(t, v, at, half, a) <= OWN))
			return false;
		take_window(a, half, 4, best);
		return true;
	}
	for (int i = 0; i < 9; i++) {
		const ptrdiff_t there[2] = { at[0] + (i / 3 - 1) * half, at[1] + (i % 3 - 1) * half };
		double own = i == 4 ? INFINITY : try_window(t, v, there, half, a);
		if (own < off) {
			off = own;
			take_window(a, half, i, best);
		}
	}
	return off < OWN;
}

/* The largest window around a cell, or one beside it that is more than twice as large. */
static gw_range_plane find_plane(const tile *t, const cell_view *v, const ptrdiff_t at[2])
{
	gw_range_plane around = { .half = 0 }, beside = { .half = 0 };
	for (size_t i = 0; i < sizeof halves / sizeof *halves && around.half == 0; i++) {
		if (!try_size(t, v, at, halves[i], false, &around) && beside.half == 0)
			try_size(t, v, at, halves[i], true, &beside);
		if (beside.half > 2 * halves[i])
			break;
	}
	return 2 * around.half < beside.half ? beside : around;
}

static void plane_of_cell(const plane_job *job, const tile *t, size_t row, size_t column)
{
	const gw_range_grid *grid = job->grid;
	const gw_range_image *image = grid->image;
	if (row >= image->rows || column >= image->columns)
		return;
	size_t cell = row * image->columns + column;
	cell_view v;
	if (!gw_range_way(grid, cell, v.axis[0]))
		return;
	double range = sqrt(dot(v.axis[0], v.axis[0]));
	for (size_t k = 0; k < 3; k++)
		v.axis[0][k] /= range;
	make_axes(v.axis[0], v.axis[1], v.axis[2]);
	v.inverse = 1.0 / range;
	double noise = fmax((double)grid->noise[gw_range_bin(range)], FLAT * grid->step * range);
	v.noise = noise / (range * range);
	const ptrdiff_t at[2] = { (ptrdiff_t)row - t->row, (ptrdiff_t)column - t->column };
	job->plane[grid->point[cell] - image->first] = find_plane(t, &v, at);
}

static void planes_of_tile(void *user, size_t first, size_t last, uint32_t worker)
{
	const plane_job *job = user;
	for (size_t i = first; i < last; i++) {
		size_t row = i / job->tiles_across * TILE, column = i % job->tiles_across * TILE;
		tile t = { .column = (ptrdiff_t)column - (ptrdiff_t)HALO,
				   .row = (ptrdiff_t)row - (ptrdiff_t)HALO };
		sum_tile(job->grid, &t, job->sums[worker]);
		for (size_t r = row; r < row + TILE; r++)
			for (size_t c = column; c < column + TILE; c++)
				plane_of_cell(job, &t, r, c);
	}
}

bool gw_range_planes_find(const gw_range_grid *grid, uint32_t threads, gw_range_plane *plane)
{
	plane_job job = { .grid = grid, .plane = plane };
	uint32_t workers = gw_thread_count(threads);
	job.sums = gw_allocate_zeros(workers, sizeof *job.sums);
	bool good = job.sums != NULL;
	for (uint32_t i = 0; good && i < workers; i++) {
		job.sums[i] = gw_allocate_array((size_t)WIDTH * WIDTH, SUMS * sizeof **job.sums);
		good = job.sums[i] != NULL;
	}
	job.tiles_across = (grid->image->columns + TILE - 1) / TILE;
	size_t tiles = job.tiles_across * ((grid->image->rows + TILE - 1) / TILE);
	if (good)
		gw_parallel_for(workers, tiles, 1, planes_of_tile, &job);
	for (uint32_t i = 0; job.sums && i < workers; i++)
		free(job.sums[i]);
	free(job.sums);
	return good;
}
