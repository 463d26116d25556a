/* albedo_clipped.c - see albedo_clipped.h. */
#include "result/albedo_clipped.h"

#include "result/albedo_places.h"

#include <math.h>
#include <stdlib.h>

/* The last value but one of 8 bits as sRGB is 0.991, the first but none 0.0003. */
#define WHITE_LEAST 0.9999f
#define BLACK_MOST 1e-6f

/* Places are twice as wide each time that one has none to ask, so often. */
#define WIDENINGS 4

size_t albedo_clipped_find(const float *photo, size_t count, uint8_t *ends)
{
	size_t found = 0;
	for (size_t i = 0; i < count; i++) {
		unsigned bits = 0;
		for (unsigned k = 0; k < 3; k++) {
			bits |= photo[3 * i + k] >= WHITE_LEAST ? ALBEDO_WHITE(k) : 0u;
			bits |= photo[3 * i + k] <= BLACK_MOST ? ALBEDO_BLACK(k) : 0u;
		}
		ends[i] = (uint8_t)bits;
		found += bits != 0;
	}
	return found;
}

static size_t list_members(const gw_points *p, const uint8_t *known, const double low[3],
						   double width, albedo_member *list)
{
	size_t used = 0;
	for (size_t i = 0; i < p->count; i++) {
		list[used] = (albedo_member){ .point = i };
		used += known[i] && albedo_place_find(p->position + 3 * i, low, width, list[used].at);
	}
	albedo_members_sort(list, used);
	return used;
}

/* By what the level of a point is above that of others, where channels of both are known. */
static float own_level(const float *level, const float mean[3], unsigned ends)
{
	double own = 0.0, others = 0.0;
	for (unsigned k = 0; k < 3; k++)
		if (!(ends & (ALBEDO_WHITE(k) | ALBEDO_BLACK(k)))) {
			own += (double)level[k];
			others += (double)mean[k];
		}
	return own > 0.0 && others > 0.0 ? (float)(own / others) : 1.0f;
}

static void fill_point(float *level, const float mean[3], unsigned ends)
{
	float own = own_level(level, mean, ends);
	for (unsigned k = 0; k < 3; k++) {
		if (ends & ALBEDO_WHITE(k))
			level[k] = fmaxf(level[k], own * mean[k]);
		else if (ends & ALBEDO_BLACK(k))
			level[k] = fminf(level[k], own * mean[k]);
	}
}

/* One place: the mean of those whose values are known, for those whose are not. */
static void fill_place(const albedo_member *list, size_t count, const uint8_t *ends, float *level,
					   uint8_t *filled)
{
	double sum[3] = { 0 };
	size_t whole = 0;
	for (size_t i = 0; i < count; i++) {
		for (size_t k = 0; k < 3 && !ends[list[i].point]; k++)
			sum[k] += (double)level[3 * list[i].point + k];
		whole += !ends[list[i].point];
	}
	if (whole == 0)
		return;
	const float mean[3] = { (float)(sum[0] / (double)whole), (float)(sum[1] / (double)whole),
							(float)(sum[2] / (double)whole) };
	for (size_t i = 0; i < count; i++) {
		size_t p = list[i].point;
		if (ends[p] && !filled[p]) {
			fill_point(level + 3 * p, mean, ends[p]);
			filled[p] = 1;
		}
	}
}

gw_status albedo_clipped_fill(const gw_points *points, const uint8_t *ends, const uint8_t *known,
							  float *level, gw_error *error)
{
	double low[3], width = albedo_place_width(points, low);
	albedo_member *list = reallocarray(NULL, points->count, sizeof *list);
	uint8_t *filled = calloc(points->count, 1);
	bool good = list && filled;
	for (int round = 0; round < WIDENINGS && good && width > 0.0; round++, width *= 2.0) {
		size_t used = list_members(points, known, low, width, list);
		for (size_t first = 0, last; first < used; first = last) {
			last = albedo_members_end(list, first, used);
			fill_place(list + first, last - first, ends, level, filled);
		}
	}
	free(list);
	free(filled);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for values that are clipped");
}
