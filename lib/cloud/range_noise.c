/*
 * range_noise.c - how much noise the ranges of an image have; see range_image.h.
 *
 * Noise changes from cell to cell, a surface hardly does: of five cells in a row, the fourth
 * difference of the inverse range is noise, but where an edge is near. So a low quantile is taken,
 * for each range by itself, since noise grows with it. Steps are seen by values that repeat; with
 * them low quantiles are 0, and how much ranges flicker is seen along lines.
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

/*
 * Cameras that match patterns flicker by more, in patches of some cells: about planes through
 * windows of 17 cells a Kinect's ranges scatter by 0.4 to 0.6 steps, which is 1.4 times as much as
 * about parabolas along lines of 17 cells. Steps and even noise of a third of one come to 0.35
 * there (simulated), a Kinect to 0.42 to 0.5. A low quantile is taken, since some lines pass edges;
 * what is more than MOST is the surface's shape.
 */
#define FLICKER_FROM 0.38
#define PATCHES 1.4
#define QUANTILE_LINE 0.4
#define STEP_NOISE_MOST 0.7

#define LINE 17
#define LINES_EVERY 4 /* cells */

#define DEPTHS 5 /* x, y, z, the range, and the depth along a camera's axis */

typedef uint32_t level_counts[GW_RANGE_BINS][LEVELS];

/* What is counted: fourth differences, and changes of each coordinate and of the range. */
typedef struct noise_counts {
	level_counts fourth, line;          /* and scatter about lines of LINE cells */
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

/* Counts how far the cells of a line, `stride` apart, scatter about a parabola, as inverse ranges
 * of what is hardly curved lie on one. */
static void count_line(const gw_range_grid *grid, size_t cell, size_t stride, noise_counts *c)
{
	/* Sums over a line of squares of the terms of first and second order that are at right angles
	 * to each other and to a constant. */
	const double first = LINE * (LINE * LINE - 1.0) / 12.0;
	const double second = first * (LINE * LINE - 4.0) / 15.0, shift = (LINE * LINE - 1.0) / 12.0;
	double term[3] = { 0 }, inverse[LINE], squares = 0.0, way[3];
	for (size_t i = 0; i < LINE; i++) {
		double x = (double)i - 0.5 * (LINE - 1);
		if (!gw_range_way(grid, cell + i * stride, way))
			return;
		inverse[i] = 1.0 / sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
		term[0] += inverse[i] / LINE;
		term[1] += inverse[i] * x / first;
		term[2] += inverse[i] * (x * x - shift) / second;
	}
	for (size_t i = 0; i < LINE; i++) {
		double x = (double)i - 0.5 * (LINE - 1);
		double off = inverse[i] - term[0] - term[1] * x - term[2] * (x * x - shift);
		squares += off * off / (LINE - 3);
	}
	c->line[gw_range_bin(1.0 / term[0])][level_of(sqrt(squares) / (term[0] * term[0]))]++;
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

static uint64_t count_lines(const noise_counts *c, uint32_t bin)
{
	uint64_t count = 0;
	for (uint32_t l = 0; l < LEVELS; l++)
		count += c->line[bin][l];
	return count;
}

/* The noise of steps, in steps: that of the ranges at which they flicker most. */
static double flicker_of(const noise_counts *c, const double step[GW_RANGE_BINS])
{
	double most = 0.0;
	for (uint32_t bin = 0; bin < GW_RANGE_BINS; bin++)
		if (step[bin] > 0.0 && count_lines(c, bin) >= SAMPLES_LEAST)
			most = fmax(most, quantile_of(c->line, bin, QUANTILE_LINE) / step[bin]);
	return most > FLICKER_FROM ? fmin(PATCHES * most, STEP_NOISE_MOST) : STEP_NOISE;
}

/* Makes the noise at least as large as steps do, and flicker between them. */
static void add_steps(const noise_counts *c, float noise[GW_RANGE_BINS])
{
	double even = 0.0, factor = 0.0, step[GW_RANGE_BINS];
	for (size_t k = 0; k < DEPTHS; k++) {
		even = fmax(even, step_of(c, k, false));
		factor = fmax(factor, step_of(c, k, true));
	}
	for (uint32_t bin = 0; bin < GW_RANGE_BINS; bin++) {
		double range = exp2(((double)bin + 0.5) / 4.0 - 12.0);
		step[bin] = fmax(even, factor * range * range);
	}
	double flicker = flicker_of(c, step);
	for (uint32_t bin = 0; bin < GW_RANGE_BINS; bin++)
		noise[bin] = fmaxf(noise[bin], (float)(flicker * step[bin]));
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
			if ((row + column) % LINES_EVERY == 0 && column + LINE <= columns)
				count_line(grid, cell, 1, c);
			if ((row + column) % LINES_EVERY == 0 && row + LINE <= rows)
				count_line(grid, cell, columns, c);
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
