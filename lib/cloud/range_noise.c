/*
 * range_noise.c - how much noise the ranges of an image have; see range_image.h.
 *
 * Noise changes from cell to cell, a surface hardly does: of five cells in a row, the fourth
 * difference of the inverse range is noise, but where an edge is near. So a low quantile is taken,
 * for each range by itself, since noise grows with it. Steps are seen by values that repeat.
 */
#include "cloud/range_steps.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEVELS 256        /* of a logarithm, four an octave from 2^-40 on */
#define SAMPLES_LEAST 400 /* that a quantile is taken of */
#define PAIRS_LEAST 40u   /* of a bin that is looked at by itself */
#define QUANTILE 0.1
#define QUANTILE_NORMAL 0.1257 /* of the absolute value of a standard normal number */
#define FOURTH 8.3666          /* sqrt(70): the fourth difference's deviation */
#define REPEATED 0.1           /* share of neighbours of one value that tells of steps */
#define STEP_LOWEST 0.02       /* shares of changes that are one step: nothing is below */
#define STEP_SHARE 0.1
#define STEP_SPREAD 1.3 /* most between the two */
#define STEP_NOISE 0.42 /* of a step: where ranges flicker between two of them */

#define DEPTHS 5 /* x, y, z, the range, and the depth along a camera's axis */

typedef uint32_t level_counts[GW_RANGE_BINS][LEVELS];

/* What is counted: fourth differences, and changes of each coordinate and of the range. */
typedef struct noise_counts {
	level_counts fourth;
	uint32_t change[2][DEPTHS][LEVELS]; /* as they are, and by the square of the depth */
	uint32_t same[DEPTHS], changed[DEPTHS], pairs[GW_RANGE_BINS];
} noise_counts;

uint32_t gw_range_bin(double range)
{
	double bin = 4.0 * (log2(range) + 12.0);
	return bin > 0.0 ? bin < GW_RANGE_BINS - 1 ? (uint32_t)bin : GW_RANGE_BINS - 1 : 0;
}

static uint32_t level_of(double value)
{
	double level = 4.0 * (log2(value) + 40.0);
	return level > 0.0 ? level < LEVELS - 1 ? (uint32_t)level : LEVELS - 1 : 0;
}

static double value_of(double level)
{
	return exp2((level + 0.5) / 4.0 - 40.0);
}

/* Counts what five cells tell, `stride` apart. */
static void count_five(const gw_range_grid *grid, size_t cell, size_t stride, const double axis[3],
					   noise_counts *c)
{
	static const double weight[5] = { 1, -4, 6, -4, 1 };
	double way[5][3], inverse[5], sum = 0.0;
	for (size_t i = 0; i < 5; i++) {
		if (!gw_range_way(grid, cell + i * stride, way[i]))
			return;
		inverse[i] =
			1.0 / sqrt(way[i][0] * way[i][0] + way[i][1] * way[i][1] + way[i][2] * way[i][2]);
		sum += weight[i] * inverse[i];
	}
	uint32_t bin = gw_range_bin(1.0 / inverse[2]);
	c->fourth[bin][level_of(fabs(sum) / (inverse[2] * inverse[2]))]++;
	c->pairs[bin]++;
	for (size_t k = 0; k < DEPTHS; k++) {
		double depth[2];
		for (size_t i = 0; i < 2; i++) {
			const double *v = way[2 + i];
			depth[i] = k < 3    ? v[k]
					   : k == 3 ? 1.0 / inverse[2 + i]
								: axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
		}
		double change = depth[0] - depth[1], square = fmax(fabs(depth[0] * depth[1]), 1e-12);
		bool same = fabs(change) * inverse[2] < 1e-6;
		c->same[k] += same;
		c->changed[k] += !same;
		c->change[0][k][level_of(fabs(change))] += !same;
		c->change[1][k][level_of(fabs(change) / square)] += !same;
	}
}

/* The quantile of a bin, together with as many bins around as it takes; 0 when there are too few.
 */
static double quantile_of(const level_counts counts, uint32_t bin, double share)
{
	for (uint32_t reach = 0; reach < 12; reach++) {
		uint32_t first = bin > reach ? bin - reach : 0;
		uint32_t last = bin + reach < GW_RANGE_BINS ? bin + reach : GW_RANGE_BINS - 1;
		uint64_t whole = 0, sum = 0;
		for (uint32_t b = first; b <= last; b++)
			for (uint32_t l = 0; l < LEVELS; l++)
				whole += counts[b][l];
		if (whole < SAMPLES_LEAST)
			continue;
		for (uint32_t l = 0; l < LEVELS; l++) {
			for (uint32_t b = first; b <= last; b++)
				sum += counts[b][l];
			if ((double)sum >= share * (double)whole)
				return value_of(l);
		}
	}
	return 0.0;
}

static double change_at(const uint32_t change[LEVELS], double rank)
{
	uint32_t level = 0;
	for (double sum = change[0]; sum < rank && level < LEVELS - 1; sum += change[level])
		level++;
	return value_of(level);
}

/*
 * The step of a coordinate, or its factor of the square of the depth; 0 when it has none. Of the
 * neighbours that differ many differ by one step, and none by less.
 */
static double step_of(const noise_counts *c, size_t k, bool squared)
{
	double changed = c->changed[k], same = c->same[k];
	if (changed < SAMPLES_LEAST || same < REPEATED * (same + changed))
		return 0.0;
	double low = change_at(c->change[squared][k], STEP_LOWEST * changed);
	double middle = change_at(c->change[squared][k], STEP_SHARE * changed);
	return middle <= STEP_SPREAD * low ? middle : 0.0;
}

/* Makes the noise at least as large as steps do. */
static void add_steps(const noise_counts *c, float noise[GW_RANGE_BINS])
{
	for (size_t k = 0; k < DEPTHS; k++) {
		double even = step_of(c, k, false), factor = step_of(c, k, true);
		for (uint32_t bin = 0; bin < GW_RANGE_BINS; bin++) {
			double range = exp2(((double)bin + 0.5) / 4.0 - 12.0);
			double step = fmax(even, factor * range * range);
			noise[bin] = fmaxf(noise[bin], (float)(STEP_NOISE * step));
		}
	}
}

/* Where a camera looks: the sum of two directions on opposite sides of the middle is along that,
 * whatever is missing. Of a scanner it is any direction. */
static void find_axis(const gw_range_grid *grid, double axis[3])
{
	size_t cells = (size_t)grid->image->columns * grid->image->rows;
	double sum[3] = { 0 }, length = 0.0;
	for (size_t i = 0; i < cells / 2; i++) {
		double v[3], w[3];
		if (!gw_range_way(grid, i, v) || !gw_range_way(grid, cells - 1 - i, w))
			continue;
		double a = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
		double b = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
		for (size_t k = 0; k < 3; k++)
			sum[k] += v[k] / a + w[k] / b;
	}
	for (size_t k = 0; k < 3; k++)
		length += sum[k] * sum[k];
	for (size_t k = 0; k < 3; k++)
		axis[k] = length > 0.0 ? sum[k] / sqrt(length) : 0.0;
}

/* Noise never falls with the range, nor does it grow faster than with its square: what a bin has
 * beyond that is the shape of rough surface there. */
static void bound_growth(float noise[GW_RANGE_BINS])
{
	const float growth = 1.41421356f; /* of the square of the range, from bin to bin */
	for (uint32_t bin = GW_RANGE_BINS - 1; bin > 0; bin--)
		if (noise[bin] > 0.0f)
			noise[bin - 1] = noise[bin - 1] > 0.0f ? fminf(noise[bin - 1], noise[bin]) : noise[bin];
	for (uint32_t bin = 1; bin < GW_RANGE_BINS; bin++)
		if (noise[bin - 1] > 0.0f)
			noise[bin] =
				noise[bin] > 0.0f ? fminf(noise[bin], growth * noise[bin - 1]) : noise[bin - 1];
}

bool gw_range_noise_find(gw_range_grid *grid)
{
	double axis[3];
	noise_counts *c = gw_allocate_zeros(1, sizeof *c);
	size_t columns = grid->image->columns, rows = grid->image->rows;
	if (!c)
		return false;
	find_axis(grid, axis);
	for (size_t row = 0; row < rows; row++) {
		for (size_t column = 0; column < columns; column++) {
			size_t cell = row * columns + column;
			if (grid->point[cell] == GW_NO_POINT)
				continue;
			if (column + 4 < columns)
				count_five(grid, cell, 1, axis, c);
			if (row + 4 < rows)
				count_five(grid, cell, columns, axis, c);
		}
	}
	for (uint32_t bin = 0; bin < GW_RANGE_BINS; bin++) {
		if (c->pairs[bin] < PAIRS_LEAST)
			continue;
		grid->noise[bin] =
			(float)(quantile_of(c->fourth, bin, QUANTILE) / (QUANTILE_NORMAL * FOURTH));
	}
	bound_growth(grid->noise);
	add_steps(c, grid->noise);
	free(c);
	return true;
}
