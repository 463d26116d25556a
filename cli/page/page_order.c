#include "page/page_order.h"

#include <math.h>
#include <stdlib.h>

#define BITS (PAGE_ORDER_LEVELS - 1) /* of a coordinate */
#define STRIDE 16

/* A point's place along the curve. */
typedef struct place {
	uint64_t key;
	uint32_t point;
	uint8_t level;
	uint8_t turn; /* within the level, of STRIDE */
} place;

/* Two zeros between one bit and the next, of 21 bits. */
static uint64_t spread(uint64_t x)
{
	x = (x | x << 32) & 0x1f00000000ffffu;
	x = (x | x << 16) & 0x1f0000ff0000ffu;
	x = (x | x << 8) & 0x100f00f00f00f00fu;
	x = (x | x << 4) & 0x10c30c30c30c30c3u;
	return (x | x << 2) & 0x1249249249249249u;
}

static int compare_keys(const void *a, const void *b)
{
	const place *one = a, *other = b;
	if (one->key != other->key)
		return one->key < other->key ? -1 : 1;
	return one->point < other->point ? -1 : one->point > other->point;
}

static int compare_turns(const void *a, const void *b)
{
	const place *one = a, *other = b;
	if (one->level != other->level)
		return one->level < other->level ? -1 : 1;
	if (one->turn != other->turn)
		return one->turn < other->turn ? -1 : 1;
	return compare_keys(a, b);
}

static void find_bounds(const float *position, size_t count, double least[3], double *side)
{
	*side = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double most = -HUGE_VAL;
		least[k] = HUGE_VAL;
		for (size_t i = 0; i < count; i++) {
			least[k] = fmin(least[k], (double)position[3 * i + k]);
			most = fmax(most, (double)position[3 * i + k]);
		}
		*side = fmax(*side, most - least[k]);
	}
}

static void find_keys(const float *position, size_t count, double *side, place *places)
{
	double least[3];
	find_bounds(position, count, least, side);
	double cells = (double)(1u << BITS), scale = *side > 0.0 ? cells / *side : 0.0;
	for (size_t i = 0; i < count; i++) {
		uint64_t key = 0;
		for (size_t k = 0; k < 3; k++) {
			double at = ((double)position[3 * i + k] - least[k]) * scale;
			key |= spread((uint64_t)fmin(at, cells - 1.0)) << k;
		}
		places[i] = (place){ .key = key, .point = (uint32_t)i };
	}
}

/* The first level that has the point and the one before it in two cells; the last, if none has. */
static uint8_t level_of(const place *places, size_t i)
{
	if (i == 0)
		return 0;
	uint64_t differ = places[i].key ^ places[i - 1].key;
	if (differ == 0)
		return BITS;
	int highest = 63 - __builtin_clzll(differ);
	return (uint8_t)(BITS - highest / 3);
}

/* The order of a place among STRIDE: 0, 8, 4, 12, 2 and so on. */
static uint8_t turn_of(size_t rank)
{
	uint8_t turn = 0;
	for (unsigned bit = 1; bit < STRIDE; bit <<= 1)
		turn = (uint8_t)(turn << 1 | ((rank & bit) != 0));
	return turn;
}

static void find_levels(place *places, size_t count, page_order *order)
{
	size_t in_level[PAGE_ORDER_LEVELS] = { 0 }, before = 0;
	for (size_t i = 0; i < count; i++) {
		places[i].level = level_of(places, i);
		places[i].turn = turn_of(in_level[places[i].level]++);
	}
	for (size_t l = 0; l < PAGE_ORDER_LEVELS; l++)
		order->end[l] = before += in_level[l];
}

gw_status page_order_make(const float *position, size_t count, page_order *order, gw_error *error)
{
	*order = (page_order){ .count = count };
	place *places = reallocarray(NULL, count ? count : 1, sizeof *places);
	order->point = reallocarray(NULL, count ? count : 1, sizeof *order->point);
	if (!places || !order->point) {
		free(places);
		page_order_clear(order);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the order of %zu points", count);
	}
	find_keys(position, count, &order->side, places);
	qsort(places, count, sizeof *places, compare_keys);
	find_levels(places, count, order);
	qsort(places, count, sizeof *places, compare_turns);
	for (size_t i = 0; i < count; i++)
		order->point[i] = places[i].point;
	free(places);
	return GW_OK;
}

void page_order_cut(page_order *order, size_t most)
{
	order->count = order->count < most ? order->count : most;
	for (size_t l = 0; l < PAGE_ORDER_LEVELS; l++)
		order->end[l] = order->end[l] < most ? order->end[l] : most;
}

void page_order_clear(page_order *order)
{
	free(order->point);
	*order = (page_order){ .point = NULL };
}
