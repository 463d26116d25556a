/*
 * check_point_choice.c - see check_point_choice.h.
 */
#include "estimate/check_point_choice.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <math.h>
#include <stdlib.h>

#define ORDER_REACH 24u /* surfels after one in Morton order that are looked at */
#define CHUNK 4096u

/* So often, or until it cuts off less than the rest of this, a part is clipped. */
#define CLIPPINGS 40
#define CLIPPED_LAST 0.98

/* Draws that are left over by no more than this factor are none: sums of as many doubles as there
 * are points, at most 2^32, are off by less. */
#define ROUNDING (1.0 + 0x1p-20)

/* Of a point for which one record speaks, as in record_density.c. */
#define LONELY_SHARE 0.25

static uint64_t mixed(uint64_t z)
{
	z = (z + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

/* A point's own number in [0, 1). Of points that follow each other they are spread evenly, as
 * multiples of the golden ratio are, so that every stretch gets its share of the draws. */
static double number_of(uint64_t point, uint64_t seed)
{
	return (double)((mixed(seed) + point * 0x9e3779b97f4a7c15u) >> 11) * 0x1p-53;
}

/* ------------------------------------------------------------------------------------ drawing */

/* As fmin, which would be a call for each of millions. */
static double clipped(double value, double most)
{
	return value < most ? value : most;
}

static double sum_clipped(const bool *counts, const double *part, size_t points, double most)
{
	double sum = 0.0;
	for (size_t i = 0; i < points; i++)
		sum += counts[i] ? clipped(part[i], most) : 0.0;
	return sum;
}

/* What a point may have of a part at most, and into *sum what they all have then; 0 where that is
 * nothing. What is cut off makes the sum less, and with it what a point may have. */
static double most_of_part(const gw_check_point_shares *from, size_t k, uint32_t wanted,
						   double *sum)
{
	double most = INFINITY, before;
	*sum = sum_clipped(from->counts, from->part[k], from->points, most);
	if (!(*sum > 0.0) || !isfinite(*sum))
		return *sum = 0.0;
	for (int i = 0; i < CLIPPINGS; i++) {
		before = *sum;
		most = *sum / wanted;
		*sum = sum_clipped(from->counts, from->part[k], from->points, most);
		if (*sum > CLIPPED_LAST * before)
			break;
	}
	return most;
}

/* Adds the k-th part's share to the probabilities, of no point more than that it is drawn once; to
 * the even ones in place of those that are there, for the first one, whose room they may take.
 * Returns by how much they sum to more then: 1, or less where the part is of fewer points than are
 * wanted. */
static double add_part(const gw_check_point_shares *from, size_t k, uint32_t wanted, double even,
					   double *probability)
{
	const bool *counts = from->counts;
	double sum, most = most_of_part(from, k, wanted, &sum), added = 0.0;
	for (size_t i = 0; i < from->points; i++) {
		double share = sum > 0.0 && counts[i]
						   ? clipped(clipped(from->part[k][i], most) / sum, 1.0 / wanted)
						   : 0.0;
		double others = k > 0 ? probability[i] : counts[i] ? even : 0.0;
		probability[i] = others + share;
		added += share;
	}
	return added;
}

/* Of how often points are to be drawn, leaves none above once, and gives what is left to others,
 * which may bring some of these to be drawn for sure. */
static void share_draws(double *times, size_t points, uint32_t wanted)
{
	for (;;) {
		double rest = 0.0, left = wanted;
		for (size_t i = 0; i < points; i++) {
			bool sure = times[i] >= 1.0;
			times[i] = sure ? 1.0 : times[i];
			rest += sure ? 0.0 : times[i];
			left -= sure ? 1.0 : 0.0;
		}
		if (!(rest > 0.0) || left <= ROUNDING * rest)
			return;
		for (size_t i = 0; i < points; i++)
			times[i] *= times[i] < 1.0 ? left / rest : 1.0;
	}
}

typedef struct candidate {
	double ratio; /* of the point's own number to how often it is to be drawn */
	double times; /* the latter */
	uint32_t point;
} candidate;

/* Lists points whose ratio is below `most`; returns how many there are. list may be NULL. */
static size_t list_candidates(const double *times, size_t points, uint64_t seed, double most,
							  candidate *list)
{
	size_t count = 0;
	for (size_t i = 0; i < points; i++) {
		double number = number_of(i, seed);
		if (number >= most * times[i])
			continue;
		if (list)
			list[count] = (candidate){ number / times[i], times[i], (uint32_t)i };
		count++;
	}
	return count;
}

static int by_ratio(const void *a, const void *b)
{
	const candidate *x = a, *y = b;
	int order = (x->ratio > y->ratio) - (x->ratio < y->ratio);
	return order != 0 ? order : (x->point > y->point) - (x->point < y->point);
}

static int by_point(const void *a, const void *b)
{
	const candidate *x = a, *y = b;
	return (x->point > y->point) - (x->point < y->point);
}

/* The `wanted` points of the lowest ratios. False where there is no memory. */
static bool draw(const double *times, size_t points, size_t counted, uint32_t wanted, uint64_t seed,
				 gw_check_point_choice *choice)
{
	double most = 1.25;
	while (list_candidates(times, points, seed, most, NULL) < wanted)
		most *= 2.0;
	candidate *list =
		gw_allocate_array(list_candidates(times, points, seed, most, NULL), sizeof *list);
	if (!list)
		return false;
	qsort(list, list_candidates(times, points, seed, most, list), sizeof *list, by_ratio);
	qsort(list, wanted, sizeof *list, by_point);
	for (uint32_t k = 0; k < wanted; k++) {
		choice->point[k] = list[k].point;
		choice->weight[k] = 1.0 / (list[k].times * (double)counted);
	}
	choice->count = wanted;
	free(list);
	return true;
}

static void take_all(const bool *counts, size_t points, size_t counted,
					 gw_check_point_choice *choice)
{
	for (size_t i = 0; i < points; i++) {
		if (!counts[i])
			continue;
		choice->point[choice->count] = (uint32_t)i;
		choice->weight[choice->count++] = 1.0 / (double)counted;
	}
}

gw_status gw_check_point_choose(const gw_check_point_shares *shares, uint32_t wanted, uint64_t seed,
								gw_check_point_choice *choice, gw_error *error)
{
	const bool *counts = shares->counts;
	size_t points = shares->points, counted = 0;
	*choice = (gw_check_point_choice){ 0 };
	for (size_t i = 0; i < points; i++)
		counted += counts[i];
	if (counted == 0 || wanted == 0)
		return GW_OK;
	size_t room = counted < wanted ? counted : wanted;
	double whole = 1.0, even = 1.0 / (double)counted;
	double *own = shares->room ? NULL : gw_allocate_array(points, sizeof *own);
	double *probability = shares->room ? shares->room : own;
	choice->point = gw_allocate_array(room, sizeof *choice->point);
	choice->weight = gw_allocate_array(room, sizeof *choice->weight);
	if (!probability || !choice->point || !choice->weight) {
		free(own);
		gw_check_point_choice_clear(choice);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to draw from %zu points", points);
	}
	for (size_t i = 0; i < points && shares->part_count == 0; i++)
		probability[i] = counts[i] ? even : 0.0;
	for (size_t k = 0; k < shares->part_count; k++)
		whole += add_part(shares, k, wanted, even, probability);
	for (size_t i = 0; i < points; i++)
		probability[i] *= wanted / whole;
	bool drawn = counted > wanted;
	if (drawn) {
		share_draws(probability, points, wanted);
		drawn = draw(probability, points, counted, wanted, seed, choice);
	} else {
		take_all(counts, points, counted, choice);
	}
	free(own);
	if (drawn || counted <= wanted)
		return GW_OK;
	gw_check_point_choice_clear(choice);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to draw from %zu points", points);
}

void gw_check_point_choice_clear(gw_check_point_choice *choice)
{
	free(choice->point);
	free(choice->weight);
	*choice = (gw_check_point_choice){ 0 };
}

gw_check_point_mean gw_check_point_average(const gw_check_point_choice *choice, const double *value)
{
	double n = choice->count, sum = 0.0, square = 0.0;
	for (uint32_t i = 0; i < choice->count; i++)
		sum += choice->weight[i] * value[i];
	for (uint32_t i = 0; i < choice->count; i++) {
		double off = n * choice->weight[i] * value[i] - sum;
		square += off * off;
	}
	return (gw_check_point_mean){ .mean = sum, .variance = square / (n * (n - 1.0)) };
}

/* ------------------------------------------------------------------------------------- shares */

typedef struct contrast_work {
	const gw_surfels *surfels;
	const float *light;
	double *contrast;
} contrast_work;

/* A chunk's surfels, and how many neighbours of each were found so far. */
typedef struct contrast_part {
	const contrast_work *work;
	size_t first, last;
	uint8_t neighbours[CHUNK];
} contrast_part;

/* Adds what surfels i < j say of each other, to those of them that are in the chunk. */
static inline void compare_pair(contrast_part *part, size_t i, size_t j)
{
	const contrast_work *w = part->work;
	const gw_surfels *s = w->surfels;
	const float *p = s->position + 3 * i, *q = s->position + 3 * j;
	float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
	float squared = x * x + y * y + z * z;
	bool reach[2] = { i >= part->first && squared < s->radius[i] * s->radius[i],
					  j < part->last && squared < s->radius[j] * s->radius[j] };
	if (!(reach[0] || reach[1]) || !gw_surfels_alike(s, i, j))
		return;
	double off = (double)w->light[i] - (double)w->light[j];
	for (size_t k = 0; k < 2; k++) {
		size_t surfel = k ? j : i;
		if (!reach[k])
			continue;
		w->contrast[surfel] += off * off;
		part->neighbours[surfel - part->first]++;
	}
}

static void contrast_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const contrast_work *w = user;
	contrast_part part = { .work = w, .first = first, .last = last };
	size_t from = first > ORDER_REACH ? first - ORDER_REACH : 0, count = w->surfels->count;
	(void)worker;
	for (size_t i = first; i < last; i++)
		w->contrast[i] = 0.0;
	for (size_t i = from; i < last; i++) {
		size_t end = i + ORDER_REACH < count ? i + ORDER_REACH + 1 : count;
		for (size_t j = i < first ? first : i + 1; j < end; j++)
			compare_pair(&part, i, j);
	}
	for (size_t i = first; i < last; i++)
		if (part.neighbours[i - first] > 0)
			w->contrast[i] /= part.neighbours[i - first];
}

void gw_check_point_contrast(const gw_surfels *surfels, const float *light, uint32_t threads,
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

void gw_check_point_disagreement(const gw_read_back *rows, const double *light, uint32_t threads,
								 double *variance)
{
	disagreement_work work = { rows, light, variance };
	gw_parallel_for(threads, rows->count, CHUNK, disagreement_chunk, &work);
}
