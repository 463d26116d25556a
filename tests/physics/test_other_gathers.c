/* Light that goes from cell to cell (GW_METHOD_LPV), and rays that are followed through the maps of
 * probes (GW_METHOD_PROBES), against closed forms: a closed cube and a closed sphere that glow, an
 * even sky over a floor, a room beside a lit one. */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static gw_bake_options options_of(gw_method method)
{
	gw_bake_options options = gw_bake_options_default();
	options.method = method;
	options.rays = options.light_samples = 64;
	options.estimate_points = 0;
	return options;
}

/* All irradiance at a point, first channel. */
static double irradiance_at(const gw_bake_result *r, size_t i)
{
	return (double)r->direct_irradiance[3 * i] + (double)r->indirect_irradiance[3 * i];
}

static double mean_irradiance(const gw_bake_result *r)
{
	double sum = 0.0;
	for (size_t i = 0; i < r->count; i++)
		sum += irradiance_at(r, i);
	return sum / (double)r->count;
}

static void assert_near(const char *what, double found, double expected, double allowed)
{
	print_message("%s: %.5f of %.5f\n", what, found, expected);
	if (!(fabs(found - expected) <= allowed))
		fail_msg("%s: %.6g, not %.6g, allowed %.3g", what, found, expected, allowed);
}

static void assert_bounces_fade(const gw_report *report)
{
	for (uint32_t n = 1; n < report->bounce_count; n++)
		assert_true(report->bounce[n].energy <= report->bounce[n - 1].energy);
}

/* ---------------------------------------------------------------------------- from cell to cell */

static scene make_cube(float albedo)
{
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 30, albedo);
	return s;
}

/* Mean irradiance of the points that lie at least 0.3 from all edges of a cube of side 1. */
static double middle_irradiance(const scene *s, const gw_bake_result *r)
{
	double sum = 0.0, count = 0.0;
	for (size_t i = 0; i < s->count; i++) {
		int within = 0;
		for (int k = 0; k < 3; k++)
			within += fabs(s->position[3 * i + (size_t)k] - 0.5) < 0.2;
		sum += within == 2 ? irradiance_at(r, i) : 0.0;
		count += within == 2;
	}
	return sum / count;
}

/*
 * All send L = 1 / (1 - albedo), and so all have it: light gets into a cell before a wall through
 * five faces and from the wall, each with the same radiance. What still moves in the end, 0.2 % of
 * what each reflection sends, is not there. At edges what a wall sends goes into the cells of other
 * walls, too.
 */
static void glowing_cube(void **state)
{
	(void)state;
	for (int step = 0; step < 2; step++) {
		const float albedo = step == 1 ? 0.5f : 0.0f;
		const double expected = SCENE_PI / (1.0 - (double)albedo);
		scene s = make_cube(albedo);
		scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
		gw_points points = scene_points(&s);
		gw_bake_options options = options_of(GW_METHOD_LPV);
		options.volume_cells = 8;
		gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
		assert_near("glowing cube", middle_irradiance(&s, result), expected,
					0.002 * expected / (1.0 - (double)albedo));
		assert_bounces_fade(&result->report);
		gw_bake_result_destroy(&result);
		scene_clear(&s);
	}
}

/* Two rooms with nothing between them but a wall of two layers, 10 cm apart. What the lamp of the
 * first lights brings nothing into the second, at all. */
static void dark_room(void **state)
{
	scene s = { 0 };
	gw_light lamp = scene_point_light(0.5, 0.5, 0.5, 2.0f);
	(void)state;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 40, 0.5f);
	const size_t lit = s.count;
	scene_add_box(&s, (double[3]){ 1.1, 0, 0 }, (double[3]){ 1, 1, 1 }, 40, 0.5f);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_LPV);
	gw_bake_result *result = scene_bake(&points, &lamp, 1, &options);
	double beyond = 0.0, sum = 0.0;
	for (size_t i = 0; i < s.count; i++)
		*(i < lit ? &sum : &beyond) += (double)result->indirect_irradiance[3 * i];
	assert_true(sum > 0.0);
	assert_true(beyond == 0.0);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* ----------------------------------------------------------------------------- maps of probes */

/* In a closed sphere that glows every ray meets surface that sends 1 / (1 - albedo), whichever
 * texel shows it. */
static void glowing_sphere(void **state)
{
	const float albedo = 0.5f;
	scene s = { 0 };
	(void)state;
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, 6000, -1, albedo);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_PROBES);
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	/* What slips out of the sphere's rays is put right in the maps; the bounces end within their
	 * tolerance. */
	assert_near("glowing sphere", mean_irradiance(result), SCENE_PI / (1.0 - (double)albedo),
				(double)options.tolerance * 2.0 * SCENE_PI);
	assert_bounces_fade(&result->report);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* A lamp beside the wall of a sphere lights a small part of it, which is sampled as what emits is.
 * Whatever lies where in a sphere, each place gets as much from all that it reflects: the mean of
 * what came from the lamp, times albedo / (1 - albedo). */
static void lit_patch(void **state)
{
	const float albedo = 0.5f;
	const gw_light lamp = scene_point_light(0.0, 0.0, 0.92, 1.0f);
	scene s = { 0 };
	(void)state;
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, 6000, -1, albedo);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_PROBES);
	gw_bake_result *result = scene_bake(&points, &lamp, 1, &options);
	double direct = scene_mean(result->direct_irradiance, result->count, 0);
	double indirect = scene_mean(result->indirect_irradiance, result->count, 0);
	/* Samples, 32 for each of 1250 records and more, differ by no more than their mean: three times
	 * what is left of that in the mean of all; and the bounces end within their tolerance. */
	assert_near("lit patch", indirect, direct * (double)albedo / (1.0 - (double)albedo),
				direct * (3.0 / sqrt(32.0 * 1250.0) + 2.0 * (double)options.tolerance));
	assert_bounces_fade(&result->report);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* A floor under an even sky: no probe sees anything above it, so that all rays leave. There is no
 * free space within its bounds, and probes stand over it. */
static void sky_over_floor(void **state)
{
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 2.0f, 2.0f, 2.0f } };
	scene s = { 0 };
	(void)state;
	scene_add_patch(
		&s,
		&(scene_patch){ (double[3]){ 0 }, (double[3]){ 2, 0, 0 }, (double[3]){ 0, 2, 0 }, 60, 60 },
		0.0f);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_PROBES);
	gw_bake_result *result = scene_bake(&points, &sky, 1, &options);
	/* All but the rounding of the sum of 64 rays. */
	assert_near("floor under a sky", mean_irradiance(result), 2.0 * SCENE_PI,
				64.0 * 0x1p-24 * 2.0 * SCENE_PI);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* ------------------------------------------------------------------------------------- both */

/* A second bake of the hall, by another number of threads, has the same bytes. */
static void same_bytes(void **state)
{
	const gw_method methods[] = { GW_METHOD_LPV, GW_METHOD_PROBES };
	(void)state;
	for (int i = 0; i < 2; i++) {
		gw_bake_options options = options_of(methods[i]);
		gw_bake_result *result[2];
		options.rays = options.light_samples = 16;
		scene_bake_hall_twice(&options, result);
		gw_bake_result_destroy(&result[0]);
		gw_bake_result_destroy(&result[1]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(glowing_cube),   cmocka_unit_test(dark_room),
		cmocka_unit_test(glowing_sphere), cmocka_unit_test(sky_over_floor),
		cmocka_unit_test(lit_patch),      cmocka_unit_test(same_bytes),
	};
	return cmocka_run_group_tests_name("other gathers", tests, NULL, NULL);
}
