/* Statistics of clouds. */
#include "glowworm.h"
#include "glowworm_parts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIDE 34u
#define COUNT (SIDE * SIDE)

/* A square of points, 1/4 m apart, far from the origin. */
static void make_square(double *position, float *normal)
{
	for (size_t i = 0; i < COUNT; i++) {
		position[3 * i] = 5e5 + 0.25 * (double)(i % SIDE);
		position[3 * i + 1] = 5.4e6 + 0.25 * (double)(i / SIDE);
		position[3 * i + 2] = 100;
		normal[3 * i] = normal[3 * i + 1] = 0;
		normal[3 * i + 2] = 1;
	}
}

static void regular_points_measure_as_made(void **state)
{
	(void)state;
	static double position[3 * COUNT];
	static float normal[3 * COUNT];
	make_square(position, normal);
	position[0] = NAN;
	memcpy(position + 3, position + 6, 3 * sizeof *position);
	normal[5] = 0;
	normal[8] = INFINITY;
	gw_points points = { .count = COUNT, .position = position, .normal = normal };
	gw_statistics s;
	gw_error error = { 0 };
	assert_int_equal(gw_measure(&points, 2, &s, &error), GW_OK);
	assert_int_equal(s.points, COUNT);
	assert_int_equal(s.finite, COUNT - 1);
	assert_int_equal(s.duplicates, 1);
	assert_int_equal(s.normals_given, COUNT - 2);
	assert_int_equal(s.normals_bad, 2);
	for (int k = 0; k < 3; k++) /* a power of two: exact */
		assert_true(s.spacing[k] == 0.25);
	assert_true(fabs(s.density - 16) < 1e-4); /* areas are float32 */
	assert_true(s.minimum[0] == 5e5 && s.maximum[0] == 5e5 + 0.25 * (SIDE - 1));
	assert_true(s.minimum[1] == 5.4e6 && s.maximum[2] == 100);
	/* 33 spacings and leaves of 1.25 spacings: 26.4 leaves and a margin of 4 fit 2^5. */
	assert_int_equal(s.depth, 5);
	assert_true(s.memory > COUNT * 100u);
}

/* More points than are looked at, without normals: the same figures, as far as they are looked for.
 * 1150 spacings and leaves of 1.25 spacings: 920 leaves and a margin of 4 fit 2^10. */
static void large_clouds_are_sampled(void **state)
{
	(void)state;
	const size_t side = 1151, count = side * side;
	double *position = malloc(3 * count * sizeof *position);
	assert_non_null(position);
	for (size_t i = 0; i < count; i++) {
		position[3 * i] = 0.5 * (double)(i % side);
		position[3 * i + 1] = 0.5 * (double)(i / side);
		position[3 * i + 2] = 0;
	}
	memcpy(position + 3, position, 3 * sizeof *position);
	gw_points points = { .count = count, .position = position };
	gw_statistics s;
	gw_error error = { 0 };
	assert_int_equal(gw_measure(&points, 2, &s, &error), GW_OK);
	assert_int_equal(s.finite, count);
	assert_int_equal(s.duplicates, 1);
	for (int k = 0; k < 3; k++)
		assert_true(s.spacing[k] == 0.5);
	assert_true(fabs(s.density - 4) < 1e-4); /* areas are float32 */
	assert_true(s.maximum[0] == 575 && s.maximum[1] == 575);
	assert_int_equal(s.depth, 10);
	/* So much memory has room for all of them, and for no more: the halving's step. */
	const gw_bake_options usual = gw_bake_options_default();
	uint64_t fit = gw_points_in_memory(s.memory, false, true, &usual);
	assert_true(fit + count / 1000 > count && fit < count + count / 1000);
	free(position);
}

static void one_point_has_no_spacing(void **state)
{
	(void)state;
	const double position[6] = { 1, 2, 3, NAN, 0, 0 };
	gw_points points = { .count = 2, .position = position };
	gw_statistics s;
	assert_int_equal(gw_measure(&points, 1, &s, NULL), GW_OK);
	assert_int_equal(s.finite, 1);
	assert_true(s.spacing[0] == 0 && s.spacing[2] == 0);
	assert_true(isfinite(s.density) && s.depth >= 1 && s.depth <= GW_DEPTH_MAX);
}

static void nothing_to_measure_is_an_error(void **state)
{
	(void)state;
	const double position[3] = { NAN, 0, 0 };
	gw_points points = { .count = 1, .position = position };
	gw_statistics s;
	gw_error error = { 0 };
	assert_int_equal(gw_measure(&points, 1, &s, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "finite"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(regular_points_measure_as_made),
		cmocka_unit_test(large_clouds_are_sampled),
		cmocka_unit_test(one_point_has_no_spacing),
		cmocka_unit_test(nothing_to_measure_is_an_error),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
