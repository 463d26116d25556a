/* The radiance volume against closed forms: a closed sphere that glows, an even sky over a floor,
 * spherical harmonics in free space; and what a bake without a volume has of one: nothing. */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define POINTS 6000
#define RAYS 64

/* Rays slip between planes of a sphere of so many points, under 1 % as in test_furnace.c. */
#define SLIPPED 0.01

/* Of the mean direction of a cell's rays, which should be 0: twice that is what irradiance of even
 * radiance is off (band 1 of it, times 2 pi / 3, over pi). */
#define PATTERN_OFF 0.0035

static gw_bake_options options_of(uint32_t cells)
{
	gw_bake_options options = gw_bake_options_default();
	options.method = GW_METHOD_VOLUME;
	options.volume_cells = cells;
	options.rays = RAYS;
	options.estimate_points = 0;
	return options;
}

static scene make_sphere(float albedo)
{
	scene s = { 0 };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, POINTS, -1, albedo);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	return s;
}

static bool has_pass(const gw_report *report, const char *name)
{
	bool has = false;
	for (uint32_t i = 0; i < report->pass_count; i++)
		has |= strcmp(report->pass[i].name, name) == 0;
	return has;
}

/* The pattern of the rays, made again: its mean direction is as near to 0 as PATTERN_OFF says. */
static void pattern_is_even(void **state)
{
	double sum[3] = { 0 };
	(void)state;
	for (int k = 0; k < RAYS; k++) {
		double z = 1.0 - (2.0 * k + 1.0) / RAYS, level = sqrt(1.0 - z * z);
		double turn = 2.0 * SCENE_PI * fmod(k * 0.618033988749895, 1.0);
		sum[0] += level * cos(turn) / RAYS;
		sum[1] += level * sin(turn) / RAYS;
		sum[2] += z / RAYS;
	}
	double off = 2.0 * sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	if (!(off <= PATTERN_OFF))
		fail_msg("irradiance is off by %.4g", off);
}

/* In a closed sphere with emission Le and albedo rho all see L = Le / (1 - rho), so E = pi L at
 * every point, whatever the cells are: even radiance has but one harmonic. */
static void check_furnace(uint32_t cells, uint32_t harmonics, float albedo)
{
	scene s = make_sphere(albedo);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(cells);
	options.volume_harmonics = harmonics;
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	double expected = SCENE_PI / (1.0 - (double)albedo), sum = 0.0;
	for (size_t i = 0; i < s.count; i++)
		sum +=
			(double)result->direct_irradiance[3 * i] + (double)result->indirect_irradiance[3 * i];
	double mean = sum / (double)s.count / expected;
	/* Each bounce loses what slips: in all 1 / (1 - rho) times that. */
	double bound = (SLIPPED + PATTERN_OFF) / (1.0 - (double)albedo) + (double)options.tolerance;
	print_message("%u cells, %u harmonics, albedo %g: %.4f of the irradiance\n", cells, harmonics,
				  (double)albedo, mean);
	if (!(fabs(mean - 1.0) <= bound))
		fail_msg("%u cells: mean irradiance is off by %.2f %%, allowed %.2f %%", cells,
				 100.0 * (mean - 1.0), 100.0 * bound);
	assert_true(result->report.volume_cells > 0);
	assert_true(has_pass(&result->report, "volume_rays"));
	for (uint32_t n = 1; n < result->report.bounce_count; n++)
		assert_true(result->report.bounce[n].energy <= result->report.bounce[n - 1].energy);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

static void furnace(void **state)
{
	(void)state;
	check_furnace(8, 4, 0.0f);
	check_furnace(16, 4, 0.5f);
	check_furnace(16, 9, 0.5f);
	check_furnace(32, 4, 0.8f);
}

/*
 * An even sky over a floor: E = pi L. The expansion of half a sphere to band 1 has just that
 * irradiance. The middle of the floor sees its rim at least D away, so that a cell at most 3/2 h
 * above it sees sky below the horizon by an angle of up to 3 h / (2 D), where its kernel
 * L (1/4 + cos / 2) is about 1/4: 2 pi / 4 times that angle, of pi.
 */
static void sky_over_floor(void **state)
{
	enum { SIDE = 60, CELLS = 30 };
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 2.0f, 2.0f, 2.0f } };
	scene s = { 0 };
	gw_bake_options options = options_of(CELLS);
	double sum = 0.0;
	size_t middle = 0;
	(void)state;
	scene_add_patch(&s,
					&(scene_patch){ (double[3]){ 0 }, (double[3]){ 2, 0, 0 },
									(double[3]){ 0, 2, 0 }, SIDE, SIDE },
					0.0f);
	gw_points points = scene_points(&s);
	gw_bake_result *result = scene_bake(&points, &sky, 1, &options);
	for (size_t i = 0; i < s.count; i++) {
		const double *p = s.position + 3 * i;
		if (fabs(p[0] - 1.0) > 0.4 || fabs(p[1] - 1.0) > 0.4)
			continue;
		sum += (double)result->direct_irradiance[3 * i];
		middle++;
	}
	double h = 2.0 / CELLS, nearest = 0.6, mean = sum / (double)middle / (2.0 * SCENE_PI);
	/* Of RAYS rays one more or less in the sky, in each of hundreds of cells by itself: the mean is
	 * off by a tenth of that at most. */
	double bound = 0.5 * 1.5 * h / nearest + 0.1 * 2.0 / RAYS + SLIPPED;
	print_message("floor under a sky: %.4f of the irradiance\n", mean);
	if (!(fabs(mean - 1.0) <= bound))
		fail_msg("off by %.2f %%, allowed %.2f %%", 100.0 * (mean - 1.0), 100.0 * bound);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* What the surface sends: 2, or of light that goes from cell to cell, of which a sphere keeps less
 * where its surface cuts cells, what the points have in the mean. */
static double sent(gw_method method, const gw_bake_result *result)
{
	double sum = 0.0;
	for (size_t i = 0; i < result->count; i++)
		sum += (double)result->radiance[3 * i];
	return method == GW_METHOD_LPV ? sum / (double)result->count : 2.0;
}

/* Radiance in free space, by any method: in the closed sphere c_0 = L sqrt(4 pi) and all else 0. */
static void check_harmonics(gw_method method)
{
	scene s = make_sphere(0.5f);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(12);
	options.method = method;
	options.volume = true;
	options.volume_harmonics = 9;
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	const gw_volume *v = &result->volume;
	double expected = sent(method, result) * sqrt(4.0 * SCENE_PI), sum = 0.0;
	size_t within = 0;
	assert_int_equal(v->harmonics, 9);
	for (size_t i = 0; i < v->count; i++) {
		double squared = 0.0;
		for (size_t k = 0; k < 3; k++) {
			double at = v->origin[k] + ((double)v->cell[3 * i + k] + 0.5) * v->size;
			squared += at * at;
		}
		/* Outside all see its back, with a sixth of all directions at least, of which 16 rays meet
		 * some. Backs within two leaf cells, 0.12, are not seen. */
		assert_false(squared > 1.2 * 1.2 && squared < 1.35 * 1.35);
		if (squared > 0.9 * 0.9)
			continue;
		const float *c = v->radiance + 27 * i;
		sum += (double)c[0];
		within++;
		/* Of the quadrature, sqrt(4 pi) times PATTERN_OFF and twice as much for band 2, and of a
		 * ray or two that slips. */
		for (size_t j = 1; j < 9; j++)
			assert_true(fabs((double)c[3 * j]) < (4.0 * PATTERN_OFF + 4.0 / RAYS) * expected);
	}
	assert_true(within > 100);
	/* As the furnace's. */
	double bound = 2.0 * (SLIPPED + (method == GW_METHOD_CONES ? 0.03 : PATTERN_OFF));
	if (!(fabs(sum / (double)within / expected - 1.0) <= bound))
		fail_msg("%s: c_0 is %.6g, not %.6g", gw_method_name(method), sum / (double)within,
				 expected);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

static void harmonics_in_free_space(void **state)
{
	(void)state;
	for (int method = 0; method < GW_METHOD_COUNT; method++)
		check_harmonics((gw_method)method);
}

/* What is gathered to bound the bounces is no light, not even where they end before it: of a sphere
 * so black that its first reflection is the last one, E = I / r^2 at every point, and rho E / (1 -
 * rho) is all that there is to be gathered. Before, it was pi rho. */
static void bounds_are_no_light(void **state)
{
	const double rho = 1e-4;
	scene s = { 0 };
	gw_bake_options options = options_of(16);
	const gw_light lamp = scene_point_light(0.0, 0.0, 0.0, 0.01f);
	(void)state;
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, POINTS, -1, (float)rho);
	gw_points points = scene_points(&s);
	for (int method = GW_METHOD_VOLUME; method <= GW_METHOD_LPV; method++) {
		options.method = (gw_method)method;
		gw_bake_result *result = scene_bake(&points, &lamp, 1, &options);
		double sum = 0.0;
		for (size_t i = 0; i < s.count; i++)
			sum += (double)result->indirect_irradiance[3 * i] / (double)s.count;
		print_message("%s: %.3g of indirect irradiance\n", gw_method_name(options.method), sum);
		assert_int_equal(result->report.bounce_count, 1);
		assert_true(sum <= rho * 0.01 / (1.0 - rho) * (1.0 + SLIPPED));
		gw_bake_result_destroy(&result);
	}
	scene_clear(&s);
}

/* A second bake of the hall, and one by another number of threads, has the same bytes. */
static void same_bytes(void **state)
{
	gw_bake_options options = options_of(16);
	gw_bake_result *result[2];
	(void)state;
	options.volume = true;
	scene_bake_hall_twice(&options, result);
	const gw_volume *one = &result[0]->volume, *other = &result[1]->volume;
	assert_int_equal(one->count, other->count);
	assert_memory_equal(one->radiance, other->radiance, 12 * one->count * sizeof *one->radiance);
	gw_bake_result_destroy(&result[0]);
	gw_bake_result_destroy(&result[1]);
}

/* Who does not ask has no volume, and pays for none. */
static void off_is_off(void **state)
{
	scene s = make_sphere(0.5f);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(16);
	(void)state;
	options.method = GW_METHOD_RAYS;
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	assert_int_equal(result->report.volume_cells, 0);
	assert_int_equal(result->volume.count, 0);
	assert_null(result->volume.radiance);
	assert_false(has_pass(&result->report, "volume_rays"));
	assert_false(has_pass(&result->report, "volume_weights"));
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pattern_is_even),     cmocka_unit_test(furnace),
		cmocka_unit_test(sky_over_floor),      cmocka_unit_test(harmonics_in_free_space),
		cmocka_unit_test(bounds_are_no_light), cmocka_unit_test(same_bytes),
		cmocka_unit_test(off_is_off),
	};
	return cmocka_run_group_tests_name("volume", tests, NULL, NULL);
}
