/* Tests of what a scanner stood on: in a room of 5 x 4 x 3 m, with things around the scanner. */
#include "cloud/stray_mounts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#define RAYS 40000

/* What stands in the room besides: a box, in coordinates of the scanner. */
typedef struct block {
	double least[3], most[3];
} block;

static const double place[3] = { 100, 200, 300 };

/* Where a ray from 0 along `way` enters a box, or leaves it where it begins within. */
static double met(const block *b, const double way[3])
{
	double enter = -INFINITY, leave = INFINITY;
	for (int k = 0; k < 3; k++) {
		double one = b->least[k] / way[k], other = b->most[k] / way[k];
		enter = fmax(enter, fmin(one, other));
		leave = fmin(leave, fmax(one, other));
	}
	return enter > leave || leave < 0 ? INFINITY : enter > 0 ? enter : leave;
}

/* What the scanner sees of the room and a block; counts points of the block and found ones. */
static void scan_room(const block *thing, size_t scanners, size_t *of_thing, size_t *found_of_it,
					  size_t *found_else)
{
	static double position[3 * RAYS];
	static bool hit[RAYS];
	static const block room = { { -2.2, -1.9, -1.5 }, { 2.8, 2.1, 1.5 } };
	const double scanner[6] = { place[0], place[1], place[2], 0, 0, 0 };
	for (size_t i = 0; i < RAYS; i++) {
		double z = 1 - (2.0 * (double)i + 1) / RAYS, turn = 2.399963229728653 * (double)i;
		double r = sqrt(1 - z * z), way[3] = { r * cos(turn), r * sin(turn), z };
		double range = met(&room, way), nearer = met(thing, way);
		hit[i] = nearer < range;
		for (int k = 0; k < 3; k++)
			position[3 * i + (size_t)k] = place[k] + fmin(range, nearer) * way[k];
	}
	const gw_points points = {
		.count = RAYS, .position = position, .scanner = scanner, .scanner_count = scanners
	};
	uint8_t *found;
	assert_int_equal(gw_stray_mounts_find(&points, &found, NULL), GW_OK);
	*of_thing = *found_of_it = *found_else = 0;
	for (size_t i = 0; i < RAYS; i++) {
		*of_thing += hit[i];
		*found_of_it += found && found[i] && hit[i];
		*found_else += found && found[i] && !hit[i];
	}
	free(found);
}

static void assert_no_mount(const block *thing)
{
	size_t points, of_it, others;
	scan_room(thing, 1, &points, &of_it, &others);
	assert_true(points > 100);
	assert_int_equal(of_it + others, 0);
}

static void plates_are_mounts(void **state)
{
	(void)state;
	static const block plate[] = { { { -0.15, -0.15, -0.2 }, { 0.15, 0.15, -0.11 } },
								   { { -0.2, 0.12, -0.2 }, { 0.2, 0.15, 0.2 } },
								   /* A robot's back: half a metre down, and wide. */
								   { { -0.4, -0.4, -1.0 }, { 0.4, 0.4, -0.35 } } };
	for (size_t i = 0; i < sizeof plate / sizeof *plate; i++) {
		size_t points, of_it, others;
		scan_room(&plate[i], 1, &points, &of_it, &others);
		assert_true(points > RAYS / 100);
		assert_int_equal(of_it, points);
		assert_int_equal(others, 0);
		/* Of two scanners nobody knows which one saw it. */
		scan_room(&plate[i], 2, &points, &of_it, &others);
		assert_int_equal(of_it + others, 0);
	}
}

static void surfaces_that_go_on_are_none(void **state)
{
	(void)state;
	const block table = { { -1.2, -0.8, -0.35 }, { 1.2, 0.8, -0.3 } };
	const block wall = { { -2.2, 0.3, -1.5 }, { 2.8, 0.4, 1.5 } };
	const block floor = { { -2.2, -1.9, -1.5 }, { 2.8, 2.1, -0.1 } };
	assert_no_mount(&table);
	assert_no_mount(&wall);
	assert_no_mount(&floor);
}

static void things_beside_are_none(void **state)
{
	(void)state;
	const block post = { { 0.4, -0.03, -1.5 }, { 0.46, 0.03, 1.5 } };
	const block lamp = { { 0.5, 0.2, 0.3 }, { 0.6, 0.3, 0.4 } };
	/* The jamb of a door, wide enough to lie on all sides of its middle. */
	const block jamb = { { -0.1, -0.6, -0.1 }, { 0.3, -0.4, 0.5 } };
	assert_no_mount(&post);
	assert_no_mount(&lamp);
	assert_no_mount(&jamb);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(plates_are_mounts),
		cmocka_unit_test(surfaces_that_go_on_are_none),
		cmocka_unit_test(things_beside_are_none),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
