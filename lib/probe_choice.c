/*
 * probe_choice.c - see probe_choice.h.
 */
#include "probe_choice.h"

#include "memory.h"
#include "parallel.h"

#include <math.h>
#include <stdlib.h>

#define ORDER_REACH 24u /* surfels after one in Morton order that are looked at */
#define CHUNK 4096u

/* So often, or until it cuts off less than the rest of this, a part is clipped. */
#define CLIPPINGS 40
#define CLIPPED_LAST 0.98

/* Of a point for which one record speaks, as in record_density.c. */
#define LONELY_SHARE 0.25

static uint64_t next_random(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

/* [0, 1) */
static double next_unit(uint64_t *state)
{
	return (double)(next_random(state) >> 11) * 0x1p-53;
}

/* ------------------------------------------------------------------------------------ drawing */

static double sum_clipped(const bool *counts, const double *part, size_t points, double most)
{
	double sum = 0.0;
	for (size_t i = 0; i < points; i++)
		sum += counts[i] ? fmin(part[i], most) : 0.0;
	return sum;
}

/* Adds a part's share to the probabilities, which then sum to 1 more; false where it is all 0. */
static bool add_part(const bool *counts, const double *part, size_t points, uint32_t wanted,
					 double *probability)
{
	double most = INFINITY, before, sum = sum_clipped(counts, part, points, most);
	if (!(sum > 0.0) || !isfinite(sum))
		return false;
	/* What is cut off makes the sum less, and with it what a point may have. */
	for (int i = 0; i < CLIPPINGS; i++) {
		before = sum;
		most = sum / wanted;
		sum = sum_clipped(counts, part, points, most);
		if (sum > CLIPPED_LAST * before)
			break;
	}
	for (size_t i = 0; i < points; i++)
		probability[i] += counts[i] ? fmin(part[i], most) / sum : 0.0;
	return true;
}

/* One point in each of `wanted` equal stretches of the summed probabilities. */
static void draw(const double *probability, double whole, size_t points, size_t counted,
				 uint32_t wanted, uint64_t seed, gw_probe_choice *choice)
{
	uint64_t state = seed;
	double below = 0.0;
	size_t at = 0;
	for (uint32_t k = 0; k < wanted; k++) {
		double target = whole * (k + next_unit(&state)) / wanted;
		while (at + 1 < points && (below + probability[at] <= target || probability[at] == 0.0))
			below += probability[at++];
		/* Roundings may lead past the last point that counts. */
		while (probability[at] == 0.0)
			at--;
		choice->point[k] = (uint32_t)at;
		choice->weight[k] = whole / (probability[at] * (double)counted * wanted);
	}
	choice->count = wanted;
}

static void take_all(const bool *counts, size_t points, size_t counted, gw_probe_choice *choice)
{
	for (size_t i = 0; i < points; i++) {
		if (!counts[i])
			continue;
		choice->point[choice->count] = (uint32_t)i;
		choice->weight[choice->count++] = 1.0 / (double)counted;
	}
}

gw_status gw_probe_choose(const bool *counts, const double *const *part, size_t part_count,
						  size_t points, uint32_t wanted, uint64_t seed, gw_probe_choice *choice,
						  gw_error *error)
{
	size_t counted = 0;
	*choice = (gw_probe_choice){ 0 };
	for (size_t i = 0; i < points; i++)
		counted += counts[i];
	if (counted == 0 || wanted == 0)
		return GW_OK;
	size_t room = counted < wanted ? counted : wanted;
	double *probability = gw_allocate_array(points, sizeof *probability), whole = 1.0;
	choice->point = gw_allocate_array(room, sizeof *choice->point);
	choice->weight = gw_allocate_array(room, sizeof *choice->weight);
	if (!probability || !choice->point || !choice->weight) {
		free(probability);
		gw_probe_choice_clear(choice);
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory to draw from %zu points", points);
	}
	for (size_t i = 0; i < points; i++)
		probability[i] = counts[i] ? 1.0 / (double)counted : 0.0;
	for (size_t k = 0; k < part_count; k++)
		whole += add_part(counts, part[k], points, wanted, probability) ? 1.0 : 0.0;
	if (counted <= wanted)
		take_all(counts, points, counted, choice);
	else
		draw(probability, whole, points, counted, wanted, seed, choice);
	free(probability);
	return GW_OK;
}

void gw_probe_choice_clear(gw_probe_choice *choice)
{
	free(choice->point);
	free(choice->weight);
	*choice = (gw_probe_choice){ 0 };
}

gw_probe_mean gw_probe_average(const gw_probe_choice *choice, const double *value)
{
	double n = choice->count, sum = 0.0, square = 0.0;
	for (uint32_t i = 0; i < choice->count; i++)
		sum += choice->weight[i] * value[i];
	for (uint32_t i = 0; i < choice->count; i++) {
		double off = n * choice->weight[i] * value[i] - sum;
		square += off * off;
	}
	return (gw_probe_mean){ .mean = sum, .variance = square / (n * (n - 1.0)) };
}

/* ------------------------------------------------------------------------------------- shares */

typedef struct contrast_work {
	const gw_surfels *surfels;
	const float *light;
	double *contrast;
} contrast_work;

static void contrast_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const contrast_work *w = user;
	size_t count = w->surfels->count;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		size_t from = i > ORDER_REACH ? i - ORDER_REACH : 0;
		size_t to = i + ORDER_REACH < count ? i + ORDER_REACH + 1 : count;
		double sum = 0.0, neighbours = 0.0;
		for (size_t j = from; j < to; j++) {
			double off = (double)w->light[i] - (double)w->light[j];
			if (j == i || !gw_surfels_adjoin(w->surfels, i, j))
				continue;
			sum += off * off;
			neighbours += 1.0;
		}
		w->contrast[i] = neighbours > 0.0 ? sum / neighbours : 0.0;
	}
}

void gw_probe_contrast(const gw_surfels *surfels, const float *light, uint32_t threads,
					   double *contrast)
{
	contrast_work work = { surfels, light, contrast };
	gw_parallel_for(threads, surfels->count, CHUNK, contrast_chunk, &work);
}

typedef struct disagreement_work {
	const gw_read_back *rows;
	const double *light;
	double *variance;
} disagreement_work;

static void disagreement_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const disagreement_work *w = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		w->variance[i] = w->rows->first[i] < w->rows->first[i + 1]
							 ? gw_read_back_variance(w->rows, w->light, i, LONELY_SHARE)
							 : 0.0;
}

void gw_probe_disagreement(const gw_read_back *rows, const double *light, uint32_t threads,
						   double *variance)
{
	disagreement_work work = { rows, light, variance };
	gw_parallel_for(threads, rows->count, CHUNK, disagreement_chunk, &work);
}
