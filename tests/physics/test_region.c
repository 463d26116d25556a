/*
 * test_region.c - the light of a part of a scene alone: it is that of a bake of the whole, with
 * fewer records, and without what it does not depend on.
 */
#include "expected.h"
#include "glowworm_picture.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 0.5f, 0.6f, 0.8f } };

/* Points of the hall that lie to one side of it. */
static uint8_t *choose_side(const scene *s, double x_most)
{
	uint8_t *chosen = calloc(s->count, 1);
	assert_non_null(chosen);
	for (size_t i = 0; i < s->count; i++)
		chosen[i] = s->position[3 * i] < x_most;
	return chosen;
}

static gw_bake_result *bake_part(const gw_points *points, const gw_light *lights, size_t count,
								 const gw_bake_options *options, const uint8_t *chosen)
{
	const gw_region region = { .point = chosen };
	gw_bake_options own = *options;
	own.region = &region;
	return scene_bake(points, lights, count, &own);
}

static double luminance(const float *rgb)
{
	return gw_relative_luminance((double)rgb[0], (double)rgb[1], (double)rgb[2]);
}

/* Root mean square difference of reflected light at the chosen points, over its mean. */
static double difference(const scene *s, const gw_bake_result *a, const gw_bake_result *b,
						 const uint8_t *chosen)
{
	double square = 0.0, sum = 0.0;
	size_t used = 0;
	for (size_t i = 0; i < s->count; i++) {
		if (!chosen[i] || s->emission[3 * i] > 0.0f)
			continue;
		double off = luminance(a->radiance + 3 * i) - luminance(b->radiance + 3 * i);
		square += off * off;
		sum += luminance(b->radiance + 3 * i);
		used++;
	}
	assert_true(used > 0 && sum > 0.0);
	return sqrt(square / (double)used) / (sum / (double)used);
}

/* Root mean square errors add up at most; each is known to about its spread. */
static double most_apart(const gw_bake_result *a, const gw_bake_result *b)
{
	return a->report.error.gathered + a->report.error.spread + b->report.error.gathered +
		   b->report.error.spread;
}

static void expect_dark_outside(const gw_bake_result *part, const uint8_t *chosen)
{
	const float dark[3] = { 0 };
	size_t lit = 0;
	assert_non_null(part->asked);
	for (size_t i = 0; i < part->count; i++) {
		assert_int_equal(part->asked[i], chosen[i]);
		lit += chosen[i];
		if (!chosen[i])
			assert_memory_equal(part->radiance + 3 * i, dark, sizeof dark);
	}
	assert_int_equal(part->report.region_points, lit);
}

/* Lamp, sky and points that emit, in a hall: a fifth of it has the light that it has in the whole.
 */
static void test_same_light(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	scene_make_small_hall(&s);
	const gw_points points = scene_points(&s);
	const gw_light lights[] = { scene_point_light(3.0, 1.0, 1.5, 4.0f), sky };
	const gw_bake_options options = gw_bake_options_default();
	uint8_t *chosen = choose_side(&s, 0.6);
	gw_bake_result *whole = scene_bake(&points, lights, 2, &options);
	gw_bake_result *part = bake_part(&points, lights, 2, &options, chosen);
	assert_null(whole->asked);
	expect_dark_outside(part, chosen);
	assert_true(difference(&s, part, whole, chosen) < most_apart(part, whole));
	/* All see all: those elsewhere are as many as stand four times as far apart, and some more
	 * along edges. */
	const gw_report *r = &part->report;
	assert_true(r->region_records < r->records);
	assert_true((double)(r->records - r->region_records) < 0.25 * (double)whole->report.records);
	gw_bake_result_destroy(&part);
	gw_bake_result_destroy(&whole);
	free(chosen);
	scene_clear(&s);
}

/* A region of all points is the whole, to the last bit; so is the light of each lamp. */
static void test_region_of_all(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	scene_make_small_hall(&s);
	const gw_points points = scene_points(&s);
	const gw_light lights[] = { scene_point_light(3.0, 1.0, 1.5, 4.0f), sky };
	gw_bake_options options = gw_bake_options_default();
	options.lamps = true;
	uint8_t *chosen = choose_side(&s, INFINITY);
	gw_bake_result *whole = scene_bake(&points, lights, 2, &options);
	gw_bake_result *part = bake_part(&points, lights, 2, &options, chosen);
	assert_int_equal(part->report.records, whole->report.records);
	assert_int_equal(part->report.region_facets, part->report.facets);
	assert_memory_equal(part->radiance, whole->radiance, 3 * s.count * sizeof(float));
	for (size_t l = 0; l < 2; l++)
		assert_memory_equal(part->lamp[l], whole->lamp[l], 3 * s.count * sizeof(float));
	assert_true(part->report.error.relative_rms == whole->report.error.relative_rms);
	gw_bake_result_destroy(&part);
	gw_bake_result_destroy(&whole);
	free(chosen);
	scene_clear(&s);
}

/* The same bytes for any number of threads. */
static void test_threads(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	scene_make_small_hall(&s);
	const gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	uint8_t *chosen = choose_side(&s, 0.6);
	gw_bake_result *part[2];
	for (uint32_t i = 0; i < 2; i++) {
		options.threads = 1 + 2 * i;
		part[i] = bake_part(&points, &sky, 1, &options, chosen);
	}
	assert_memory_equal(part[0]->radiance, part[1]->radiance, 3 * s.count * sizeof(float));
	gw_bake_result_destroy(&part[0]);
	gw_bake_result_destroy(&part[1]);
	free(chosen);
	scene_clear(&s);
}

/* Two closed rooms, 0.5 m apart; chosen receives the points of the first. */
static uint8_t *make_rooms(scene *s)
{
	scene_add_box(s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 16.0, 0.5f);
	size_t first = s->count;
	scene_add_box(s, (double[3]){ 2.5, 0, 0 }, (double[3]){ 2, 2, 2 }, 16.0, 0.5f);
	uint8_t *chosen = calloc(s->count, 1);
	assert_non_null(chosen);
	memset(chosen, 1, first);
	return chosen;
}

/* Light of one room does not depend on the other one: what is needed is half of the surface, and a
 * lamp beyond the walls gives nothing. */
static void test_rooms_apart(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	uint8_t *chosen = make_rooms(&s);
	const gw_points points = scene_points(&s);
	const gw_light lights[] = { scene_point_light(1.0, 1.0, 1.0, 4.0f),
								scene_point_light(3.5, 1.0, 1.0, 4.0f) };
	const gw_bake_options options = gw_bake_options_default();
	gw_bake_result *part = bake_part(&points, lights, 2, &options, chosen);
	const gw_report *r = &part->report;
	/* Facets are of both rooms alike; cells at edges are cut differently, by one row in 2 m. */
	assert_true(fabs((double)r->region_facets / (double)r->facets - 0.5) < 0.02);
	assert_true(part->given[0].share > 0.99);
	assert_true(part->given[1].share < 0.01);
	gw_bake_result_destroy(&part);
	gw_bake_result *dark = bake_part(&points, lights + 1, 1, &options, chosen);
	/* A lamp in the other room reaches none of the points. */
	for (size_t i = 0; i < s.count; i++)
		assert_true(!chosen[i] || luminance(dark->radiance + 3 * i) == 0.0);
	gw_bake_result_destroy(&dark);
	free(chosen);
	scene_clear(&s);
}

/* The radius of each point's disc; the caller frees it. */
static float *make_radii(const gw_points *points)
{
	gw_surfels surfels;
	gw_error error = { 0 };
	float *radius = calloc(points->count, sizeof *radius);
	assert_non_null(radius);
	assert_ok(gw_surfels_make(points, &(gw_surfels_options){ .threads = 1 }, &surfels, &error),
			  &error);
	for (size_t i = 0; i < points->count; i++)
		radius[i] = surfels.radius[surfels.surfel_of_point[i]];
	gw_surfels_clear(&surfels);
	return radius;
}

/* A camera in one of two rooms sees what is in front of it there, also where only its disc reaches
 * into the picture, and through no wall. */
static void test_camera(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	uint8_t *chosen = make_rooms(&s);
	const gw_points points = scene_points(&s);
	const gw_light lamp = scene_point_light(1.0, 1.0, 1.0, 4.0f);
	gw_bake_options options = gw_bake_options_default();
	gw_camera camera;
	gw_error error = { 0 };
	/* To the wall between the rooms, 90 degrees wide and high: from its middle, 1 m before it. */
	assert_ok(gw_camera_look(&camera, (double[3]){ 1, 1, 1 }, (double[3]){ 2, 1, 1 },
							 (double[3]){ 0, 0, 1 }, 90.0, &error),
			  &error);
	const gw_region region = { .camera = &camera, .aspect = 1.0 };
	options.region = &region;
	gw_bake_result *part = scene_bake(&points, &lamp, 1, &options);
	float *radius = make_radii(&points);
	for (size_t i = 0; i < s.count; i++) {
		const double *p = s.position + 3 * i;
		double across = fmax(fabs(p[1] - 1.0), fabs(p[2] - 1.0)), along = p[0] - 1.0;
		double outside = across - along - (double)radius[i];
		/* A disc that just touches the rim of the picture may be on either side of it. */
		if (along > 0.0 && fabs(outside) > 1e-3)
			assert_int_equal(part->asked[i], chosen[i] && outside < 0.0);
		assert_true(along > 0.0 || !part->asked[i]);
	}
	free(radius);
	gw_bake_result_destroy(&part);
	free(chosen);
	scene_clear(&s);
}

/* A scene that is prepared for a region gives what a bake of the region gives. */
static void test_scene_of_region(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	scene_make_small_hall(&s);
	const gw_points points = scene_points(&s);
	const gw_light lights[] = { scene_point_light(3.0, 1.0, 1.5, 4.0f), sky };
	uint8_t *chosen = choose_side(&s, 0.6);
	const gw_region region = { .point = chosen };
	gw_bake_options options = gw_bake_options_default();
	scene_choose_passes(&options.passes, &options.validate);
	options.region = &region;
	gw_bake_result *part = scene_bake(&points, lights, 2, &options);
	gw_scene *made = NULL;
	gw_lighting *lighting = NULL;
	gw_error error = { 0 };
	float *radiance = calloc(3 * s.count, sizeof *radiance);
	assert_non_null(radiance);
	assert_ok(gw_scene_create(&(gw_scene_description){ .points = &points }, &options, NULL, &made,
							  &error),
			  &error);
	memset(chosen, 0, s.count); /* the scene needs it no more */
	assert_ok(gw_lighting_create(made, lights, 2, &lighting, &error), &error);
	assert_ok(gw_lighting_radiance(lighting, radiance, &error), &error);
	assert_memory_equal(radiance, part->radiance, 3 * s.count * sizeof *radiance);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&made);
	gw_bake_result_destroy(&part);
	free(radiance);
	free(chosen);
	scene_clear(&s);
}

/* A coarse room about a ball whose points are much denser: discs of the walls are too large for
 * leaves, and lamps shine on them by themselves, whenever records are placed anew. */
static void make_uneven(scene *s)
{
	*s = (scene){ 0 };
	scene_add_box(s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 3, 0.5f);
	scene_add_sphere(s, (double[3]){ 1, 1, 0.5 }, 0.05, 280, 1, 0.5f);
}

/* A region begins with the spacing of a whole bake that has few records, and adds some where they
 * disagree. */
static void test_few_records(void **state)
{
	(void)state;
	scene s;
	make_uneven(&s);
	const gw_points points = scene_points(&s);
	const gw_light lights[] = { scene_point_light(0.5, 1.0, 1.5, 4.0f), sky };
	gw_bake_options options = gw_bake_options_default();
	uint8_t *chosen = choose_side(&s, 1.0);
	options.least_records = options.most_records = 0;
	gw_bake_result *all = scene_bake(&points, lights, 2, &options);
	options.most_records = (uint32_t)all->report.records / 3;
	options.gathered_error = 0.0f;
	gw_bake_result *few = scene_bake(&points, lights, 2, &options);
	gw_bake_result *part = bake_part(&points, lights, 2, &options, chosen);
	assert_true(few->report.record_spacing > all->report.record_spacing);
	assert_true(part->report.record_spacing == few->report.record_spacing);
	options.gathered_error = 1e-6f; /* out of reach: as close as others stand */
	gw_bake_result *more = bake_part(&points, lights, 2, &options, chosen);
	assert_true(more->report.round_count >= 2);
	assert_true(more->report.records > part->report.records);
	expect_dark_outside(more, chosen);
	assert_true(difference(&s, more, all, chosen) < most_apart(more, all));
	gw_bake_result *const every[] = { all, few, part, more };
	for (size_t i = 0; i < sizeof every / sizeof *every; i++) {
		gw_bake_result *result = every[i];
		gw_bake_result_destroy(&result);
	}
	free(chosen);
	scene_clear(&s);
}

/* Refining puts more records into the region until its error is as small as asked. */
static void test_refined(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	scene_make_hall(&s);
	const gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	gw_bake_options_set_start(&options);
	uint8_t *chosen = choose_side(&s, 0.6);
	gw_bake_result *coarse = bake_part(&points, &sky, 1, &options, chosen);
	options.max_error = (float)(0.6 * coarse->report.error.relative_rms);
	gw_bake_result *fine = bake_part(&points, &sky, 1, &options, chosen);
	expect_dark_outside(fine, chosen);
	assert_int_equal(fine->report.goal, GW_GOAL_REACHED);
	assert_true(fine->report.records > coarse->report.records);
	gw_bake_result_destroy(&fine);
	gw_bake_result_destroy(&coarse);
	free(chosen);
	scene_clear(&s);
}

static void expect_refused(const gw_points *points, const gw_bake_options *options,
						   gw_status status)
{
	gw_bake_result *result = NULL;
	gw_error error = { 0 };
	const gw_scene_description description = { points, &sky, 1 };
	assert_int_equal(gw_bake(&description, options, NULL, &result, &error), status);
	assert_null(result);
	assert_true(error.text[0] != '\0');
}

/* What a region has not is refused; so is one without points. */
static void test_refused(void **state)
{
	(void)state;
	scene s = { .count = 0 };
	scene_make_small_hall(&s);
	const gw_points points = scene_points(&s);
	uint8_t *chosen = choose_side(&s, -1.0);
	gw_region region = { .point = chosen };
	gw_bake_options options = gw_bake_options_default();
	options.region = &region;
	expect_refused(&points, &options, GW_ERROR_DATA);
	gw_bake_options other = options;
	other.method = GW_METHOD_CONES;
	expect_refused(&points, &other, GW_ERROR_USAGE);
	other = options;
	other.voxels = true;
	expect_refused(&points, &other, GW_ERROR_USAGE);
	gw_camera camera = { .tangent = 1.0 };
	region = (gw_region){ .camera = &camera };
	expect_refused(&points, &options, GW_ERROR_USAGE);
	gw_bake_result *plan = NULL;
	gw_error error = { 0 };
	const gw_scene_description description = { &points, &sky, 1 };
	region = (gw_region){ .point = NULL };
	assert_int_equal(gw_plan_bake(&description, &options, NULL, &plan, &error), GW_ERROR_USAGE);
	free(chosen);
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_same_light),      cmocka_unit_test(test_region_of_all),
		cmocka_unit_test(test_threads),         cmocka_unit_test(test_rooms_apart),
		cmocka_unit_test(test_camera),          cmocka_unit_test(test_few_records),
		cmocka_unit_test(test_scene_of_region), cmocka_unit_test(test_refined),
		cmocka_unit_test(test_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
