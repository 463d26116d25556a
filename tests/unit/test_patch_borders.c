/* What neighbouring surfels say about their patches, summed chunk by chunk. */
#include "normals/patch_borders.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SURFELS 30000u /* several chunks */
#define PATCHES 40u

static uint32_t near[GW_NEIGHBOURS * SURFELS], patch[SURFELS];
static int8_t agreement[GW_NEIGHBOURS * SURFELS];
static uint8_t opposite[SURFELS];

static uint32_t next(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return *state >> 8;
}

/* Patches change along the surfels, as in Morton order, and neighbours are close by or anywhere. */
static gw_patch_pairs make_pairs(bool alike)
{
	uint32_t state = 1;
	for (uint32_t i = 0; i < SURFELS; i++) {
		patch[i] = (i / 300 + next(&state) % 3) % PATCHES;
		opposite[i] = next(&state) & 1;
		for (uint32_t j = 0; j < GW_NEIGHBOURS; j++) {
			uint32_t other =
				next(&state) % 8 ? (i + next(&state) % 20) % SURFELS : next(&state) % SURFELS;
			near[GW_NEIGHBOURS * i + j] = other;
			agreement[GW_NEIGHBOURS * i + j] =
				(int8_t)((int)(next(&state) % (2 * GW_AGREED + 1)) - GW_AGREED);
		}
	}
	return (gw_patch_pairs){ SURFELS, near, agreement, patch, opposite, alike };
}

/* The sums of whole numbers below 2^53, which are exact in any order. */
static void sum_pairs(bool alike, double says[PATCHES][PATCHES], double weight[PATCHES][PATCHES])
{
	for (size_t pair = 0; pair < (size_t)GW_NEIGHBOURS * SURFELS; pair++) {
		size_t i = pair / GW_NEIGHBOURS, j = near[pair];
		uint32_t a = patch[i] < patch[j] ? patch[i] : patch[j];
		uint32_t b = patch[i] < patch[j] ? patch[j] : patch[i];
		double sure = abs(agreement[pair]);
		if (alike)
			sure = round(sqrt(GW_AGREED * sure));
		if (a == b)
			continue;
		weight[a][b] += sure;
		says[a][b] += (opposite[i] == opposite[j]) == (agreement[pair] > 0) ? sure : -sure;
	}
}

static void check_borders(bool alike)
{
	static double says[PATCHES][PATCHES], weight[PATCHES][PATCHES];
	const gw_patch_pairs pairs = make_pairs(alike);
	gw_patch_border *one, *three;
	size_t count, again;
	memset(says, 0, sizeof says);
	memset(weight, 0, sizeof weight);
	sum_pairs(alike, says, weight);
	assert_true(gw_patch_borders_find(&pairs, 1, &one, &count));
	assert_true(gw_patch_borders_find(&pairs, 3, &three, &again));
	assert_int_equal(count, again);
	assert_memory_equal(one, three, count * sizeof *one);
	size_t touching = 0;
	for (uint32_t a = 0; a < PATCHES; a++)
		for (uint32_t b = 0; b < PATCHES; b++)
			touching += weight[a][b] > 0;
	assert_int_equal(count, touching);
	for (size_t i = 0; i < count; i++) {
		assert_true(one[i].says == says[one[i].a][one[i].b]);
		assert_true(one[i].weight == weight[one[i].a][one[i].b]);
		assert_true(i == 0 || one[i - 1].a < one[i].a ||
					(one[i - 1].a == one[i].a && one[i - 1].b < one[i].b));
	}
	free(one);
	free(three);
}

static void pairs_are_summed(void **state)
{
	(void)state;
	check_borders(false);
}

static void creases_say_more(void **state)
{
	(void)state;
	check_borders(true);
}

static void one_patch_has_no_borders(void **state)
{
	(void)state;
	gw_patch_pairs pairs = make_pairs(false);
	gw_patch_border *borders;
	size_t count;
	memset(patch, 0, sizeof patch);
	assert_true(gw_patch_borders_find(&pairs, 2, &borders, &count));
	assert_int_equal(count, 0);
	free(borders);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pairs_are_summed),
		cmocka_unit_test(creases_say_more),
		cmocka_unit_test(one_patch_has_no_borders),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
