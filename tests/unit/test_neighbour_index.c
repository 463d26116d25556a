/*
 * test_neighbour_index.c - what the order and the neighbours of points are found by, on several
 * threads: keys sorted, and FLANN's trees against brute force.
 */
#include "base/hash.h"
#include "base/key_sort.h"
#include "base/memory.h"
#include "cloud/neighbour_index.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define KEYS 70000   /* so many that four threads sort them in parts */
#define POINTS 70000 /* so many that they have four trees */
#define QUERIES 20
#define FEW 9    /* kept in a list */
#define MANY 300 /* kept in a heap */

static uint32_t number(uint64_t seed, uint32_t i)
{
	return (uint32_t)gw_hash(seed, &i, sizeof i);
}

/* ---------------------------------------------------------------------------------------- keys */

static gw_keyed *make_keys(size_t count, uint64_t mask)
{
	gw_keyed *keys = gw_allocate_array(count, sizeof *keys);
	assert_non_null(keys);
	for (uint32_t i = 0; i < count; i++)
		keys[i] = (gw_keyed){ ((uint64_t)number(1, i) << 32 | number(2, i)) & mask, .item = i };
	return keys;
}

static int by_key_and_item(const void *a, const void *b)
{
	const gw_keyed *p = a, *q = b;
	if (p->key != q->key)
		return p->key < q->key ? -1 : 1;
	return (p->item > q->item) - (p->item < q->item);
}

static void assert_sorts(size_t count, uint64_t mask, unsigned bits, uint32_t threads)
{
	gw_keyed *keys = make_keys(count, mask), *expected = make_keys(count, mask);
	qsort(expected, count, sizeof *expected, by_key_and_item);
	assert_true(gw_sort_keyed(&keys, count, bits, threads));
	for (size_t i = 0; i < count; i++) {
		assert_true(keys[i].key == expected[i].key);
		assert_int_equal(keys[i].item, expected[i].item);
	}
	free(keys);
	free(expected);
}

static void keys_are_sorted_and_equal_ones_stay_in_order(void **state)
{
	(void)state;
	assert_sorts(KEYS, UINT64_MAX, 64, 1);
	assert_sorts(KEYS, UINT64_MAX, 64, 4);
	/* Only a thousand different ones, in digits that others lie between. */
	assert_sorts(KEYS, UINT64_C(0x3e0000000000001f), 64, 4);
	/* The same key everywhere, one element, and none. */
	assert_sorts(KEYS, 0, 64, 4);
	assert_sorts(1, UINT64_MAX, 64, 4);
	assert_sorts(0, UINT64_MAX, 64, 4);
}

/* Bits beyond those that are asked for do not count. */
static void keys_are_sorted_by_the_bits_asked_for(void **state)
{
	(void)state;
	gw_keyed *keys = gw_allocate_array(2, sizeof *keys);
	assert_non_null(keys);
	keys[0] = (gw_keyed){ UINT64_C(1) << 40 | 1, .item = 0 };
	keys[1] = (gw_keyed){ UINT64_C(2), .item = 1 };
	assert_true(gw_sort_keyed(&keys, 2, 22, 1));
	assert_int_equal(keys[0].item, 0);
	assert_true(gw_sort_keyed(&keys, 2, 44, 1));
	assert_int_equal(keys[0].item, 1);
	free(keys);
}

/* -------------------------------------------------------------------------------------- points */

/* A place on a grid of so many steps a side: in coarse ones many are equally far. */
static void place(uint32_t i, uint32_t steps, float at[3])
{
	for (uint32_t k = 0; k < 3; k++)
		at[k] = (float)(number(3 + k, i) % steps) / (float)steps;
}

static float *make_places(uint32_t steps)
{
	float *places = gw_allocate_array(POINTS, 3 * sizeof *places);
	assert_non_null(places);
	for (uint32_t i = 0; i < POINTS; i++)
		place(i, steps, places + 3 * (size_t)i);
	return places;
}

static float squared_distance(const float *a, const float *b)
{
	float sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (a[k] - b[k]) * (a[k] - b[k]);
	return sum;
}

typedef struct candidate {
	float squared;
	int point;
} candidate;

static int nearer(const void *a, const void *b)
{
	const candidate *p = a, *q = b;
	if (p->squared != q->squared)
		return p->squared < q->squared ? -1 : 1;
	return (p->point > q->point) - (p->point < q->point);
}

/* Of points that are equally far those of the lowest numbers count, in whichever tree. */
static void assert_finds(const float *places, const uint8_t *gone, size_t k, uint32_t threads)
{
	gw_neighbour_index *index = gw_neighbour_index_build(places, POINTS, threads);
	candidate *all = gw_allocate_array(POINTS, sizeof *all);
	float query[3], squared[MANY];
	int found[MANY];
	assert_true(index && all);
	if (gone)
		gw_neighbour_index_leave_out(index, gone);
	for (uint32_t q = 0; q < QUERIES; q++) {
		place(POINTS + q, q % 2 ? 7 + 9 * (q % 4 / 2) : 100000, query);
		query[0] += q % 5 == 0 ? 1.0f : 0.0f; /* some are beside all points */
		for (int i = 0; i < POINTS; i++)
			all[i] = (candidate){ gone && gone[i] ? INFINITY
												  : squared_distance(query, places + 3 * (size_t)i),
								  i };
		qsort(all, POINTS, sizeof *all, nearer);
		assert_true(gw_neighbour_index_search(index, query, 1, k, found, squared));
		for (size_t j = 0; j < k; j++) {
			assert_int_equal(found[j], all[j].point);
			assert_true(squared[j] == all[j].squared);
		}
	}
	gw_neighbour_index_free(index);
	free(all);
}

static void neighbours_are_those_of_brute_force(void **state)
{
	(void)state;
	/* Of few steps many points are at each place; a seventh is no binary fraction. */
	const uint32_t steps[] = { 100000, 16, 7 };
	for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
		float *places = make_places(steps[i]);
		assert_finds(places, NULL, FEW, 1);
		assert_finds(places, NULL, FEW, 4);
		assert_finds(places, NULL, MANY, 4);
		free(places);
	}
}

/* Half of the points, by chance, as if they were not there. */
static void what_is_left_out_is_not_found(void **state)
{
	(void)state;
	float *places = make_places(16);
	uint8_t *gone = gw_allocate_array(POINTS, sizeof *gone);
	assert_non_null(gone);
	for (uint32_t i = 0; i < POINTS; i++)
		gone[i] = number(9, i) % 2;
	assert_finds(places, gone, FEW, 4);
	assert_finds(places, gone, MANY, 4);
	free(gone);
	free(places);
}

static void what_is_not_finite_is_refused(void **state)
{
	(void)state;
	float *places = make_places(100000), squared;
	const float query[3] = { NAN, 0, 0 };
	int found;
	gw_neighbour_index *index = gw_neighbour_index_build(places, POINTS, 2);
	assert_non_null(index);
	assert_false(gw_neighbour_index_search(index, query, 1, 1, &found, &squared));
	gw_neighbour_index_free(index);
	places[3 * (POINTS - 1)] = INFINITY;
	assert_null(gw_neighbour_index_build(places, POINTS, 2));
	free(places);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keys_are_sorted_and_equal_ones_stay_in_order),
		cmocka_unit_test(keys_are_sorted_by_the_bits_asked_for),
		cmocka_unit_test(neighbours_are_those_of_brute_force),
		cmocka_unit_test(what_is_left_out_is_not_found),
		cmocka_unit_test(what_is_not_finite_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
