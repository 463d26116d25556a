/* Where an airborne sensor was, from scan angles and times: two flight lines over hills and a roof,
 * and clouds that only look as if. */
#include "las/las_flight.h"
#include "cloud/surfels.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define BEAMS 20000
#define SPEED 60.0
#define HEIGHT 900.0
#define EAST 500000.0

static const char *const names[6] = { "x",        "y",
									  "z",        "scan_angle_rank",
									  "gps_time", "point_source_id" };

typedef struct flown {
	scan cloud;
	double *value[6];
	double *sensor; /* 3 a point */
} flown;

static flown make(size_t count)
{
	flown f = { .cloud = { .count = count, .up = 'z' }, .sensor = calloc(3 * count, 8) };
	gw_error error;
	assert_non_null(f.sensor);
	for (int c = 0; c < 6; c++)
		assert_non_null(scan_add_column(&f.cloud, names[c], SCAN_FLOAT64, &error));
	for (int c = 0; c < 6; c++)
		f.value[c] = scan_find(&f.cloud, names[c])->data;
	return f;
}

static void clear(flown *f)
{
	scan_clear(&f->cloud);
	free(f->sensor);
}

static void find(flown *f)
{
	gw_error error;
	assert_ok(las_flight_find(&f->cloud, &error), &error);
}

static double ground(double x, double y)
{
	bool roof = fabs(x - EAST) < 12 && fabs(y) < 8;
	return roof ? 40 : 20 * sin(x / 90) * cos(y / 70);
}

/* Where a beam from the sensor, across the way of flight, meets the ground. */
static void send_beam(flown *f, size_t i, const double way[2], double degrees)
{
	double *s = f->sensor + 3 * i, z = 0, tangent = tan(degrees * M_PI / 180);
	for (int round = 0; round < 20; round++) {
		f->value[0][i] = s[0] + way[1] * (s[2] - z) * tangent;
		f->value[1][i] = s[1] - way[0] * (s[2] - z) * tangent;
		z = ground(f->value[0][i], f->value[1][i]);
	}
	f->value[2][i] = z;
	f->value[3][i] = rint(degrees);
}

/* Two lines, north-east and back, of three seconds each, 50 sweeps a second; the aircraft sways.
 * Beams leave it at so many degrees around those of the middle, on the same side of the ground. */
static flown fly_at(double middle, double degrees)
{
	flown f = make(BEAMS);
	const double way[2] = { 0.8, 0.6 };
	for (size_t i = 0; i < BEAMS; i++) {
		bool back = i >= BEAMS / 2;
		double seconds = 3 * (double)(i % (BEAMS / 2)) / (BEAMS / 2) - 1.5, turn = back ? -1 : 1;
		double sweep = 2 * fabs(fmod(50 * (seconds + 2), 1) - 0.5) - 0.5;
		double roll = sin(2 * seconds), to[2] = { turn * way[0], turn * way[1] };
		for (size_t k = 0; k < 2; k++)
			f.sensor[3 * i + k] = SPEED * seconds * to[k] + (k ? 0 : EAST);
		f.sensor[3 * i + 2] = HEIGHT;
		send_beam(&f, i, to, turn * middle + degrees * (sweep + roll / 40));
		f.value[4][i] = 250000 + seconds + (back ? 600 : 0);
		f.value[5][i] = back ? 12 : 11;
	}
	return f;
}

static flown fly(void)
{
	return fly_at(0, 40);
}

/* Share of the points whose sensor is known and lies in the true direction to within 0.1 rad. */
static double found_share(const flown *f)
{
	size_t right = 0;
	for (size_t i = 0; i < f->cloud.count && f->cloud.scanner_of; i++) {
		uint32_t scanner = f->cloud.scanner_of[i];
		if (scanner == SCAN_NO_SCANNER)
			continue;
		assert_true(scanner < f->cloud.scanner_count);
		double off = 0;
		for (size_t k = 0; k < 3; k++)
			off = hypot(off, f->cloud.scanner[3 * scanner + k] - f->sensor[3 * i + k]);
		right += off < 0.1 * HEIGHT;
	}
	return (double)right / (double)f->cloud.count;
}

static void two_lines(void **state)
{
	(void)state;
	flown f = fly();
	find(&f);
	assert_true(found_share(&f) > 0.999);
	assert_true(f.cloud.scanner_count >= 4);
	assert_int_equal(f.cloud.comment_count, 1);
	clear(&f);
}

/* In steps of 0.006 degrees, and the order in the file for times that are missing. */
static void fine_angles_without_times(void **state)
{
	(void)state;
	flown f = fly();
	gw_error error;
	scan_column *fine = scan_add_column(&f.cloud, "scan_angle", SCAN_INT16, &error);
	assert_non_null(fine);
	for (size_t i = 0; i < BEAMS; i++)
		scan_store(fine, i, rint(scan_value(scan_find(&f.cloud, "scan_angle_rank"), i) / 0.006));
	scan_remove_column(&f.cloud, "scan_angle_rank");
	scan_remove_column(&f.cloud, "gps_time");
	find(&f);
	assert_true(found_share(&f) > 0.999);
	clear(&f);
}

/* A tile of which each line saw one degree or two tells no height, but that it was seen from above;
 * without times, or where a beam did not go down, it may be anything. */
static void pieces_are_seen_from_above(void **state)
{
	(void)state;
	for (int kind = 0; kind < 3; kind++) {
		flown f = fly_at(9.5, 1);
		if (kind == 1)
			scan_remove_column(&f.cloud, "gps_time");
		if (kind == 2)
			f.value[3][77] = 80;
		find(&f);
		assert_int_equal(f.cloud.scanner_count, kind == 0);
		assert_int_equal(f.cloud.comment_count, kind == 0);
		if (kind == 0) {
			assert_non_null(strstr(f.cloud.comment[0], "from -10 to 10 degrees"));
			assert_true(fabs(f.cloud.scanner[0] - EAST) < 300);
			assert_true(f.cloud.scanner[2] > HEIGHT);
		}
		clear(&f);
	}
}

/* A lamp between roof and ground lights what nobody saw: the side that was seen stays the front. In
 * a model at a thousandth of the scale nothing else tells that it was seen from above, as wide
 * ground does of which points are decimetres apart. */
static void seen_sides_are_fronts(void **state)
{
	(void)state;
	flown f = fly();
	find(&f);
	double *position = calloc(3 * BEAMS, sizeof *position);
	assert_non_null(position);
	for (size_t i = 0; i < BEAMS; i++)
		for (size_t k = 0; k < 3; k++)
			position[3 * i + k] = 1e-3 * f.value[k][i];
	for (size_t k = 0; k < 3 * f.cloud.scanner_count; k++)
		f.cloud.scanner[k] *= 1e-3;
	const gw_light lamp = { .type = GW_LIGHT_POINT,
							.position = { 1e-3 * EAST, 0, -30e-3 },
							.intensity = { 1, 1, 1 } };
	const gw_surfels_options options = { .lights = &lamp, .light_count = 1 };
	for (int known = 0; known < 2; known++) {
		const gw_points points = { .count = BEAMS,
								   .position = position,
								   .scanner = f.cloud.scanner,
								   .scanner_count = known ? f.cloud.scanner_count : 0,
								   .scanner_of = f.cloud.scanner_of };
		gw_surfels s;
		gw_error error;
		size_t up = 0;
		assert_ok(gw_surfels_make(&points, &options, &s, &error), &error);
		for (size_t i = 0; i < s.count; i++)
			up += s.normal[3 * i + 2] > 0;
		if (known)
			assert_true((double)up > 0.995 * (double)s.count);
		else
			assert_true((double)up < 0.1 * (double)s.count);
		gw_surfels_clear(&s);
	}
	free(position);
	clear(&f);
}

/* Scans from the ground have no angles, or such that say nothing; a ball that was given angles by
 * where its points are has points on both sides of it at the same angle. */
static void others_are_left_alone(void **state)
{
	(void)state;
	for (int kind = 0; kind < 3; kind++) {
		flown f = fly();
		for (size_t i = 0; i < BEAMS; i++) {
			double turn = 2.399963229728653 * (double)i, z = 1 - 2 * ((double)i + 0.5) / BEAMS;
			double r = sqrt(1 - z * z);
			f.value[0][i] = kind < 2 ? f.value[0][i] : 100 * r * cos(turn);
			f.value[1][i] = kind < 2 ? f.value[1][i] : 100 * r * sin(turn);
			f.value[2][i] = kind < 2 ? f.value[2][i] : 100 * z;
			f.value[3][i] = kind == 0   ? 0
							: kind == 1 ? fmod(7919 * (double)i, 61) - 30
										: rint(45 * r * cos(turn));
			f.value[4][i] = kind == 2 ? 42 + 0.5 * r * sin(turn) : f.value[4][i];
		}
		find(&f);
		assert_int_equal(f.cloud.scanner_count, 0);
		assert_null(f.cloud.scanner_of);
		assert_int_equal(f.cloud.comment_count, 0);
		clear(&f);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(two_lines),
		cmocka_unit_test(fine_angles_without_times),
		cmocka_unit_test(pieces_are_seen_from_above),
		cmocka_unit_test(seen_sides_are_fronts),
		cmocka_unit_test(others_are_left_alone),
	};
	return cmocka_run_group_tests_name("las flight", tests, NULL, NULL);
}
