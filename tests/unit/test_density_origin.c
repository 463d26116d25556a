/* Tests of where a cloud was scanned from, told by its density: a box of a room, 5 x 4 x 3 m. */
#include "glowworm_picture.h"

#include "random_numbers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define POINTS 20000
#define COLUMNS 200

/*
 * The area of a place is told by 13 points, which is 1 / sqrt(13) = 0.28 off at most, and changes
 * as the square of the distance: so the distance is 0.14 off by one place, and 0.14 / sqrt(1000) of
 * it by a thousand, of those that tell of one direction. Three deviations of that, of 4 m at most.
 */
#define PLACE_OFF (3 * 0.14 / 31.6 * 4.0)

static const double half[3] = { 2.5, 2, 1.5 };
static const double middle[3] = { 500100, 4100200, 300 };

typedef struct room_scan {
	double position[2 * 3 * POINTS];
	size_t count;
	uint64_t random;
} room_scan;

/* Where the beam from a scanner meets the room, with noise along it. */
static void add_beam(room_scan *s, const double scanner[3], const double way[3], double noise)
{
	double range = INFINITY;
	for (int k = 0; k < 3; k++)
		range = fmin(range, ((way[k] >= 0 ? half[k] : -half[k]) - scanner[k]) / way[k]);
	range += noise * random_normal(&s->random);
	for (int k = 0; k < 3; k++)
		s->position[3 * s->count + (size_t)k] = middle[k] + scanner[k] + range * way[k];
	s->count++;
}

/* Beams that are even over the sphere. */
static void scan_evenly(room_scan *s, const double scanner[3], double noise)
{
	for (size_t i = 0; i < POINTS; i++) {
		double z = 1 - (2.0 * (double)i + 1) / POINTS, turn = 2.399963229728653 * (double)i;
		double r = sqrt(1 - z * z), way[3] = { r * cos(turn), r * sin(turn), z };
		add_beam(s, scanner, way, noise);
	}
}

/* Those of a scanner that turns about z: columns and rows of equal angles, but for a cone below. */
static void scan_turning(room_scan *s, const double scanner[3], double noise)
{
	for (size_t i = 0; i < POINTS; i++) {
		double turn = 2 * M_PI * (double)(i / (POINTS / COLUMNS)) / COLUMNS;
		double up = -1 + 2.5 * ((double)(i % (POINTS / COLUMNS)) + 0.5) / (POINTS / COLUMNS);
		double way[3] = { cos(up) * cos(turn), cos(up) * sin(turn), sin(up) };
		add_beam(s, scanner, way, noise);
	}
}

/* The same of one that rolls about y, as a fan of beams that is carried along. */
static void scan_rolling(room_scan *s, const double scanner[3], double noise)
{
	for (size_t i = 0; i < POINTS; i++) {
		double turn = 2 * M_PI * (double)(i / (POINTS / COLUMNS)) / COLUMNS;
		double aside = -1 + 2.5 * ((double)(i % (POINTS / COLUMNS)) + 0.5) / (POINTS / COLUMNS);
		double way[3] = { cos(aside) * cos(turn), sin(aside), cos(aside) * sin(turn) };
		add_beam(s, scanner, way, noise);
	}
}

/* A depth camera's, through a pinhole, towards a corner. */
static void scan_picture(room_scan *s, const double scanner[3], double noise)
{
	for (size_t i = 0; i < POINTS; i++) {
		double u = 1.2 * ((double)(i % COLUMNS) + 0.5) / COLUMNS - 0.6;
		double v = 0.9 * ((double)(i / COLUMNS) + 0.5) / (POINTS / COLUMNS) - 0.45;
		double way[3] = { 0.8 - u * 0.6, 0.6 + u * 0.8, v }, length = 0;
		for (int k = 0; k < 3; k++)
			length += way[k] * way[k];
		for (int k = 0; k < 3; k++)
			way[k] /= sqrt(length);
		add_beam(s, scanner, way, noise);
	}
}

/* Places on the walls that no scanner chose. */
static void sample_evenly(room_scan *s)
{
	const double area[3] = { 3 * 4, 5 * 3, 5 * 4 };
	for (size_t i = 0; i < POINTS; i++) {
		double chosen = random_number(&s->random) * (area[0] + area[1] + area[2]);
		int side = chosen < area[0] ? 0 : chosen < area[0] + area[1] ? 1 : 2;
		for (int k = 0; k < 3; k++) {
			double u = 2 * random_number(&s->random) - 1;
			s->position[3 * s->count + (size_t)k] = middle[k] + half[k] * (k != side ? u
																		   : u < 0   ? -1
																					 : 1);
		}
		s->count++;
	}
}

/* One point of each cube. */
static void thin_by_grid(room_scan *s, double width)
{
	static uint8_t taken[64][64][64];
	size_t kept = 0;
	memset(taken, 0, sizeof taken);
	for (size_t i = 0; i < s->count; i++) {
		size_t cell[3];
		for (int k = 0; k < 3; k++)
			cell[k] = (size_t)((s->position[3 * i + (size_t)k] - middle[k] + 3) / width);
		uint8_t *of = &taken[cell[0]][cell[1]][cell[2]];
		if (!*of)
			memmove(s->position + 3 * kept++, s->position + 3 * i, 3 * sizeof *s->position);
		*of = 1;
	}
	s->count = kept;
}

static bool find(const room_scan *s, double found[3])
{
	const gw_points points = { .count = s->count, .position = s->position };
	return gw_points_find_scanner(&points, found);
}

static void assert_found(const room_scan *s, const double scanner[3])
{
	double found[3], again[3];
	assert_true(find(s, found));
	for (int k = 0; k < 3; k++)
		assert_true(fabs(found[k] - middle[k] - scanner[k]) < PLACE_OFF);
	assert_true(find(s, again));
	assert_memory_equal(found, again, sizeof found);
}

static void one_scanner_is_found(void **state)
{
	static const double scanner[3] = { 0.7, -0.9, -0.2 };
	static void (*const scan[])(room_scan *, const double *, double) = { scan_evenly, scan_turning,
																		 scan_rolling };
	room_scan *s = *state;
	for (size_t i = 0; i < sizeof scan / sizeof *scan; i++) {
		*s = (room_scan){ .random = 1 };
		scan[i](s, scanner, 0.003);
		assert_found(s, scanner);
	}
}

/* Of two walls that a camera sees, its place and where it looks explain much the same. What it is
 * looked for are sides: it stands within the room, and looks at both from there. */
static void a_camera_is_found_in_its_room(void **state)
{
	static const double camera[3] = { 0.7, -0.9, -0.2 };
	double found[3];
	room_scan *s = *state;
	*s = (room_scan){ .random = 1 };
	scan_picture(s, camera, 0.003);
	assert_true(find(s, found));
	for (int k = 0; k < 3; k++)
		assert_true(fabs(found[k] - middle[k]) < half[k]);
}

static void strays_do_no_harm(void **state)
{
	static const double scanner[3] = { 0.7, -0.9, -0.2 };
	room_scan *s = *state;
	*s = (room_scan){ .random = 1 };
	scan_evenly(s, scanner, 0.003);
	for (size_t i = 0; i < 30; i++)
		for (size_t k = 0; k < 3; k++)
			s->position[3 * (i * 600 + 7) + k] = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e9 : NAN;
	assert_found(s, scanner);
}

static void other_points_were_not_seen_from_one_place(void **state)
{
	static const double scanner[3] = { 0.7, -0.9, -0.2 }, other[3] = { -1.5, 1.1, 0.1 };
	double found[3];
	room_scan *s = *state;
	*s = (room_scan){ .random = 1 };
	sample_evenly(s);
	assert_false(find(s, found));
	s->count = 0;
	scan_evenly(s, scanner, 0.003);
	scan_evenly(s, other, 0.003);
	assert_false(find(s, found));
	s->count = 0;
	scan_evenly(s, scanner, 0.003);
	thin_by_grid(s, 0.125);
	assert_false(find(s, found));
	s->count = 100;
	assert_false(find(s, found));
}

static int make_room(void **state)
{
	*state = calloc(1, sizeof(room_scan));
	return *state ? 0 : -1;
}

static int free_room(void **state)
{
	free(*state);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_scanner_is_found),
		cmocka_unit_test(a_camera_is_found_in_its_room),
		cmocka_unit_test(strays_do_no_harm),
		cmocka_unit_test(other_points_were_not_seen_from_one_place),
	};
	return cmocka_run_group_tests(tests, make_room, free_room);
}
