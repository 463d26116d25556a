/* Places to stand: one in each room, on floor that is free to head height, whatever the order of
 * the points. */
#include "scene/floor_places.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct cloud {
	double *at;
	size_t count, room;
} cloud;

/* So far from each other are points of a plane. */
#define SPACING 0.04

static void add(cloud *c, double x, double y, double z)
{
	if (c->count == c->room) {
		c->room = c->room ? 2 * c->room : 1024;
		c->at = reallocarray(c->at, c->room, 3 * sizeof *c->at);
		assert_non_null(c->at);
	}
	memcpy(c->at + 3 * c->count++, (double[]){ x, y, z }, 3 * sizeof *c->at);
}

/* A rectangle from one corner to the opposite one, which are alike in one coordinate. */
static void add_plane(cloud *c, double x0, double y0, double z0, const double to[3])
{
	const double from[3] = { x0, y0, z0 };
	size_t steps[3];
	for (int k = 0; k < 3; k++)
		steps[k] = (size_t)lround((to[k] - from[k]) / SPACING) + 1;
	for (size_t i = 0; i < steps[0]; i++)
		for (size_t j = 0; j < steps[1]; j++)
			for (size_t k = 0; k < steps[2]; k++)
				add(c, x0 + (double)i * SPACING, y0 + (double)j * SPACING,
					z0 + (double)k * SPACING);
}

static void add_room(cloud *c, double x, double width, double depth, double height)
{
	add_plane(c, x, 0, 0, (double[]){ x + width, depth, 0 });
	add_plane(c, x, 0, height, (double[]){ x + width, depth, height });
	add_plane(c, x, 0, 0, (double[]){ x + width, 0, height });
	add_plane(c, x, depth, 0, (double[]){ x + width, depth, height });
	add_plane(c, x, 0, 0, (double[]){ x, depth, height });
	add_plane(c, x + width, 0, 0, (double[]){ x + width, depth, height });
}

static size_t find(const cloud *c, char up, double place[3 * FLOOR_PLACES_MAX])
{
	size_t found = 0;
	gw_error error = { 0 };
	if (floor_places_find(c->at, c->count, up, place, &found, &error) != GW_OK)
		fail_msg("%s", error.text);
	return found;
}

/* The same points in another order, which a generator of full period makes. */
static cloud shuffled(const cloud *c)
{
	cloud other = { 0 };
	size_t size = 1, at = 0;
	while (size < c->count)
		size *= 2;
	for (size_t i = 0; i < size; i++) {
		at = (5 * at + 12345) & (size - 1);
		if (at < c->count)
			add(&other, c->at[3 * at], c->at[3 * at + 1], c->at[3 * at + 2]);
	}
	assert_int_equal(other.count, c->count);
	return other;
}

/* A room of 6 by 4 m with a table in its middle, and beside it one of 2 by 4; strays far away. */
static void test_rooms(void **state)
{
	(void)state;
	cloud c = { 0 };
	double place[3 * FLOOR_PLACES_MAX], again[3 * FLOOR_PLACES_MAX];
	add_room(&c, 0, 6, 4, 2.8);
	add_room(&c, 6.2, 2, 4, 2.8);
	add_plane(&c, 2, 1.2, 0.76, (double[]){ 4, 2.8, 0.76 });
	for (int i = 0; i < 20; i++)
		add(&c, 1e9 + i, -1e7, 1e8);
	size_t found = find(&c, 'z', place), in_room[2] = { 0 };
	for (size_t i = 0; i < found; i++) {
		const double *p = place + 3 * i;
		bool second = p[0] > 6.1;
		/* Walls are as far away as a person reaches, less a cube of a decimetre. */
		double low = (second ? 6.2 : 0.0) + FLOOR_REACH - 0.1,
			   high = (second ? 8.2 : 6.0) - FLOOR_REACH + 0.1;
		in_room[second]++;
		assert_true(p[0] >= low && p[0] <= high);
		assert_true(p[1] >= FLOOR_REACH - 0.1 && p[1] <= 4.0 - FLOOR_REACH + 0.1);
		assert_true(p[2] == 0.0);
		assert_false(p[0] > 2.0 && p[0] < 4.0 && p[1] > 1.2 && p[1] < 2.8);
	}
	assert_true(in_room[0] >= 2 && in_room[1] >= 1);
	cloud other = shuffled(&c);
	assert_int_equal(find(&other, 'z', again), found);
	assert_memory_equal(place, again, 3 * found * sizeof *place);
	free(other.at);
	free(c.at);
}

/* Rooms of which the floor was not seen everywhere have no places on their ceilings, and rooms too
 * low to stand in have none at all. */
static void test_ceilings(void **state)
{
	(void)state;
	double place[3 * FLOOR_PLACES_MAX];
	cloud seen = { 0 }, low = { 0 };
	add_plane(&seen, 0, 0, 0, (double[]){ 2, 4, 0 });
	add_plane(&seen, 0, 0, 2.8, (double[]){ 5, 4, 2.8 });
	size_t found = find(&seen, 'z', place);
	assert_true(found >= 1);
	for (size_t i = 0; i < found; i++)
		assert_true(place[3 * i + 2] == 0.0);
	add_room(&low, 0, 4, 4, 1.4);
	assert_int_equal(find(&low, 'z', place), 0);
	free(seen.at);
	free(low.at);
}

/* A slope in the open of one point a square metre, with y up; and no points. */
static void test_slope(void **state)
{
	(void)state;
	double place[3 * FLOOR_PLACES_MAX];
	cloud c = { 0 };
	for (int i = 0; i < 60; i++)
		for (int j = 0; j < 60; j++)
			add(&c, i + 0.3 * sin(j), 0.2 * i, j + 0.3 * sin(i));
	size_t found = find(&c, 'y', place);
	assert_true(found >= 4);
	for (size_t i = 0; i < found; i++) /* of a cube of at most 3.2 m the highest point */
		assert_true(fabs(place[3 * i + 1] - 0.2 * place[3 * i]) <= 0.2 * 3.2);
	c.count = 0;
	assert_int_equal(find(&c, 'z', place), 0);
	free(c.at);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_rooms),
		cmocka_unit_test(test_ceilings),
		cmocka_unit_test(test_slope),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
