/* test_scene.c - a scene that is prepared once and lit often gives what single bakes give; what it
 * tells meanwhile, and how soon it stops. */
#include "expected.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static void same_floats(const float *a, const float *b, size_t count)
{
	assert_memory_equal(a, b, count * sizeof *a);
}

static void same_results(const gw_bake_result *a, const gw_bake_result *b)
{
	assert_int_equal(a->count, b->count);
	same_floats(a->radiance, b->radiance, 3 * a->count);
	same_floats(a->direct_irradiance, b->direct_irradiance, 3 * a->count);
	same_floats(a->indirect_irradiance, b->indirect_irradiance, 3 * a->count);
	same_floats(a->normal, b->normal, 3 * a->count);
	same_floats(a->roi, b->roi, a->count);
	assert_int_equal(a->lamp_count, b->lamp_count);
	for (size_t i = 0; i < a->lamp_count; i++)
		same_floats(a->lamp[i], b->lamp[i], 3 * a->count);
	assert_int_equal(a->rest == NULL, b->rest == NULL);
	if (a->ambient_occlusion)
		same_floats(a->ambient_occlusion, b->ambient_occlusion, a->count);
	if (a->bent_normal)
		same_floats(a->bent_normal, b->bent_normal, 3 * a->count);
	if (a->error)
		same_floats(a->error, b->error, a->count);
	assert_int_equal(a->voxels.count, b->voxels.count);
	if (a->voxels.count > 0)
		same_floats(a->voxels.radiance, b->voxels.radiance, 3 * a->voxels.count);
}

static gw_light sky(float radiance)
{
	return (gw_light){ .type = GW_LIGHT_ENVIRONMENT, .radiance = { radiance, radiance, radiance } };
}

/* What is compared are bakes with bakes, which any number of rays lets be the same. */
static gw_bake_options few_rays(void)
{
	gw_bake_options options = gw_bake_options_default();
	options.rays = options.light_samples = 16;
	return options;
}

static gw_scene *make(const scene *hall, const gw_bake_options *options,
					  const gw_bake_callbacks *callbacks)
{
	gw_points points = scene_points(hall);
	gw_scene *made = NULL;
	gw_error error = { 0 };
	gw_bake_options own = *options; /* by the passes of the bakes that it is held against */
	scene_choose_passes(&own.passes, &own.validate);
	assert_ok(gw_scene_create(&(gw_scene_description){ .points = &points }, &own, callbacks, &made,
							  &error),
			  &error);
	assert_int_equal(gw_scene_point_count(made), hall->count);
	return made;
}

/* The light of `lighting` is that of a bake, by all ways to ask for it. */
static void expect_bake(const scene *hall, gw_lighting *lighting, const gw_light *lights,
						size_t count, const gw_bake_options *options)
{
	gw_points points = scene_points(hall);
	gw_error error = { 0 };
	gw_error_estimate estimate;
	gw_bake_result *baked = scene_bake(&points, lights, count, options), *read = NULL;
	float *radiance = calloc(3 * hall->count, sizeof *radiance);
	assert_non_null(radiance);
	assert_ok(gw_lighting_radiance(lighting, radiance, &error), &error);
	same_floats(radiance, baked->radiance, 3 * hall->count);
	assert_ok(gw_lighting_error(lighting, &estimate, &error), &error);
	assert_true(estimate.points == baked->report.error.points);
	assert_true(estimate.relative_rms == baked->report.error.relative_rms);
	assert_ok(gw_lighting_result(lighting, &read, &error), &error);
	same_results(read, baked);
	assert_int_equal(read->report.bounce_count, baked->report.bounce_count);
	gw_bake_result_destroy(&read);
	gw_bake_result_destroy(&baked);
	free(radiance);
}

static uint64_t repaired(const gw_report *r)
{
	for (uint32_t i = 0; i < r->count_count; i++)
		if (strcmp(r->count[i].name, "emission_repaired") == 0)
			return r->count[i].points;
	return 0;
}

/* Lamps, then a sky, then nothing but the scene's own emission, and the lamps again. */
static void each_lighting_is_a_bake(void **state)
{
	(void)state;
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	gw_bake_options options = few_rays();
	options.ambient_occlusion = options.bent_normals = options.errors = options.voxels =
		options.lamps = true;
	gw_scene *made = make(&hall, &options, NULL);
	gw_lighting *lighting = NULL;
	gw_error error = { 0 };
	const gw_light lamps[2] = { scene_point_light(1.0, 1.0, 1.0, 3.0f), sky(0.5f) };
	assert_ok(gw_lighting_create(made, lamps, 2, &lighting, &error), &error);
	expect_bake(&hall, lighting, lamps, 2, &options);
	for (size_t first = 0; first < 3; first++) {
		assert_ok(gw_lighting_change(lighting, lamps + first, first < 2, &error), &error);
		expect_bake(&hall, lighting, lamps + first, first < 2, &options);
	}
	gw_lighting_destroy(&lighting);
	assert_null(lighting);
	gw_scene_destroy(&made);
	assert_null(made);
	gw_scene_destroy(&made);
	scene_clear(&hall);
}

/* Without emission a scene needs no records for a lamp alone that is not reflected. */
static void lamps_come_and_go(void **state)
{
	(void)state;
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	hall.emits = false;
	gw_bake_options options = few_rays();
	options.bounces = 1;
	gw_scene *made = make(&hall, &options, NULL);
	gw_lighting *lighting = NULL;
	gw_error error = { 0 };
	const gw_light lights[3] = { sky(1.0f), scene_point_light(1.0, 1.0, 1.0, 3.0f), sky(2.0f) };
	assert_ok(gw_lighting_create(made, lights, 1, &lighting, &error), &error);
	for (size_t i = 0; i < 3; i++) {
		assert_ok(gw_lighting_change(lighting, lights + i, 1, &error), &error);
		expect_bake(&hall, lighting, lights + i, 1, &options);
	}
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&made);
	scene_clear(&hall);
}

/* Means as of a bake. Means of emission over facets are taken in another order than the octree's,
 * and samples follow shares of power, which a rounding can turn from one facet to its neighbour. */
static void expect_means(const scene *hall, gw_lighting *lighting, const gw_light *lamp,
						 const gw_bake_options *options)
{
	gw_points points = scene_points(hall);
	gw_error error = { 0 };
	gw_bake_result *baked = scene_bake(&points, lamp, 1, options), *read = NULL;
	assert_ok(gw_lighting_result(lighting, &read, &error), &error);
	for (size_t k = 0; k < 3; k++) {
		double a = scene_mean(baked->radiance, baked->count, k);
		double b = scene_mean(read->radiance, read->count, k);
		if (!(fabs(a - b) <= 1e-3 * a))
			fail_msg("means %g and %g", a, b);
	}
	assert_int_equal(repaired(&read->report), repaired(&baked->report));
	gw_bake_result_destroy(&read);
	gw_bake_result_destroy(&baked);
}

/* Points that emit other light, then none, then what they did, but for one that cannot: each time
 * as in a bake of them. What was lit before is not read by mistake. */
static void emission_is_switched(void **state)
{
	(void)state;
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	gw_bake_options options = few_rays();
	options.lamps = options.voxels = true;
	gw_scene *made = make(&hall, &options, NULL);
	gw_lighting *lighting = NULL;
	gw_error error = { 0 };
	float value, *first = calloc(3 * hall.count, sizeof *first);
	const gw_light lamp = scene_point_light(1.0, 1.0, 1.0, 3.0f);
	assert_non_null(first);
	memcpy(first, hall.emission, 3 * hall.count * sizeof *first);
	assert_ok(gw_lighting_create(made, &lamp, 1, &lighting, &error), &error);
	for (int turn = 0; turn < 4; turn++) {
		hall.emits = turn != 1;
		for (size_t i = 0; i < 3 * hall.count; i++)
			hall.emission[i] = turn == 0 ? (i / 3 % 50 == 0 ? 4.0f : 0.0f) : first[i];
		hall.emission[0] = turn == 2 ? -1.0f : 0.0f;
		assert_ok(gw_scene_change_emission(made, hall.emits ? hall.emission : NULL, &error),
				  &error);
		assert_int_equal(gw_lighting_radiance(lighting, &value, &error), GW_ERROR_USAGE);
		assert_non_null(strstr(error.text, "other emission"));
		assert_ok(gw_lighting_change(lighting, &lamp, 1, &error), &error);
		assert_int_equal(repaired(gw_scene_report(made)), turn == 2);
		if (hall.emits)
			expect_means(&hall, lighting, &lamp, &options);
		else
			expect_bake(&hall, lighting, &lamp, 1, &options);
	}
	free(first);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&made);
	scene_clear(&hall);
}

/* What an older lighting is asked is about its own light. */
static void lightings_stand_side_by_side(void **state)
{
	(void)state;
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	gw_bake_options options = few_rays();
	options.voxels = true;
	gw_scene *made = make(&hall, &options, NULL);
	gw_lighting *one = NULL, *other = NULL;
	gw_error error = { 0 };
	const gw_light lamps[2] = { scene_point_light(1.0, 1.0, 1.0, 3.0f), sky(0.5f) };
	assert_ok(gw_lighting_create(made, lamps, 1, &one, &error), &error);
	assert_ok(gw_lighting_create(made, lamps + 1, 1, &other, &error), &error);
	expect_bake(&hall, one, lamps, 1, &options);
	expect_bake(&hall, other, lamps + 1, 1, &options);
	gw_lighting_destroy(&one);
	expect_bake(&hall, other, lamps + 1, 1, &options);
	gw_lighting_destroy(&other);
	gw_scene_destroy(&made);
	scene_clear(&hall);
}

/* Points so small or light so strong that it is reckoned in other units come back in their own. */
static void units_come_back(void **state)
{
	(void)state;
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	for (size_t i = 0; i < 3 * hall.count; i++)
		hall.position[i] = ldexp(hall.position[i], -60);
	gw_bake_options options = few_rays();
	gw_scene *made = make(&hall, &options, NULL);
	gw_lighting *lighting = NULL;
	gw_error error = { 0 };
	gw_light lamp = scene_point_light(ldexp(1.0, -60), ldexp(1.0, -60), ldexp(1.0, -60), 0x1p-118f);
	assert_ok(gw_lighting_create(made, &lamp, 1, &lighting, &error), &error);
	expect_bake(&hall, lighting, &lamp, 1, &options);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&made);
	scene_clear(&hall);
}

/* ------------------------------------------------------------------------------ while it works */

typedef struct watch {
	int left; /* so many more questions are answered with no; below 0: all are */
	double done, last, longest;
	unsigned told, stages;
	char stage[32];
} watch;

/* Seconds of this thread alone, which other programs do not lengthen. */
static double thread_seconds(void)
{
	struct timespec time;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void see_progress(void *user, const char *stage, double done)
{
	watch *w = user;
	bool next = strcmp(stage, w->stage) != 0;
	assert_true(done >= w->done && done <= 1.0);
	w->done = done;
	w->told++;
	w->stages += next;
	snprintf(w->stage, sizeof w->stage, "%s", stage);
}

static bool ask_to_stop(void *user)
{
	watch *w = user;
	double now = thread_seconds();
	w->longest = w->last > 0.0 ? fmax(w->longest, now - w->last) : 0.0;
	w->last = now;
	return w->left >= 0 && w->left-- == 0;
}

static gw_points plain_points(const scene *box)
{
	gw_points points = scene_points(box);
	points.normal = NULL;
	return points;
}

/* The longest time that this bake goes without a question, as a share of all, but for the tenth of
   a second that it leaves between two of them. */
static double longest_share(const scene *box)
{
	gw_points points = plain_points(box);
	gw_light lamp = scene_point_light(2.0, 1.5, 1.5, 5.0f);
	watch w = { .left = -1 };
	gw_bake_callbacks callbacks = { see_progress, ask_to_stop, &w, NULL };
	gw_bake_result *result = NULL;
	gw_error error = { 0 };
	double begin = thread_seconds();
	assert_ok(
		gw_bake(&(gw_scene_description){ &points, &lamp, 1 }, NULL, &callbacks, &result, &error),
		&error);
	gw_bake_result_destroy(&result);
	double seconds = thread_seconds() - begin;
	/* Within stages, too: somebody who watches hears of a bake twice a second. */
	assert_true(w.told > w.stages && w.told > 2.0 * seconds);
	return (w.longest - 0.1) / seconds;
}

/*
 * 100,000 points without normals, whose surface takes the longest: some 2.5 seconds of the thread
 * that asks, 7.5 for 300,000, of which half a second between two questions is a fifteenth. A share,
 * because slow machines are slow at all of it; and the least of three, because what else a machine
 * does can only make a pause longer.
 */
static void it_asks_and_tells_all_the_time(void **state)
{
	(void)state;
	scene box = { 0 };
	scene_add_box(&box, (const double[3]){ 0, 0, 0 }, (const double[3]){ 4, 3, 2.5 }, 42.0, 0.6f);
	assert_true(box.count > 90000);
	double share = longest_share(&box);
	for (int again = 0; again < 2 && share >= 1.0 / 15.0; again++)
		share = fmin(share, longest_share(&box));
	assert_true(share < 1.0 / 15.0);
	scene_clear(&box);
}

/* A scene that was stopped while it was lit is as good as before. */
static void stopping_leaves_the_scene(void **state)
{
	(void)state;
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	watch w = { .left = -1 };
	gw_bake_callbacks callbacks = { NULL, ask_to_stop, &w, NULL };
	gw_bake_options options = few_rays();
	gw_scene *made = make(&hall, &options, &callbacks);
	gw_lighting *lighting = NULL;
	gw_error error = { 0 };
	const gw_light lights[2] = { scene_point_light(1.0, 1.0, 1.0, 3.0f), sky(0.5f) };
	assert_ok(gw_lighting_create(made, lights, 2, &lighting, &error), &error);
	for (int asked = 0; asked < 4; asked++) {
		float radiance[3];
		w.left = asked;
		assert_int_equal(gw_lighting_change(lighting, lights, 2, &error), GW_ERROR_CANCELLED);
		assert_int_equal(gw_lighting_radiance(lighting, radiance, &error), GW_ERROR_USAGE);
		w.left = -1;
		assert_ok(gw_lighting_change(lighting, lights, 2, &error), &error);
		expect_bake(&hall, lighting, lights, 2, &options);
	}
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&made);
	scene_clear(&hall);
}

#define SKY_WIDTH 64
#define SKY_HEIGHT 32

/* A sky of radiance 1 east of the meridian or west of it, and nothing elsewhere. */
static gw_light half_sky(bool east, float *pixels)
{
	for (uint32_t i = 0; i < SKY_WIDTH * SKY_HEIGHT; i++)
		for (uint32_t c = 0; c < 3; c++)
			pixels[3 * i + c] = (i % SKY_WIDTH >= SKY_WIDTH / 2) == east ? 1.0f : 0.0f;
	return (gw_light){ .type = GW_LIGHT_ENVIRONMENT,
					   .radiance = { 1, 1, 1 },
					   .map = pixels,
					   .map_width = SKY_WIDTH,
					   .map_height = SKY_HEIGHT };
}

/* Nobody can say which side of a bare sheet that stands in the open is its front. So whichever side
 * the light comes from later, the sheet has it: the half of the sky that its side looks at lights
 * it as a whole sky would, L = albedo, but for what the samples of a map err by, 3 % or so. */
static void either_side_of_a_sheet_is_lit(void **state)
{
	(void)state;
	static float pixels[3 * SKY_WIDTH * SKY_HEIGHT];
	scene sheet = { 0 };
	scene_add_patch(&sheet,
					&(scene_patch){ (double[3]){ 0, 0, 0 }, (double[3]){ 0, 2, 0 },
									(double[3]){ 0, 0, 1 }, 64, 32 },
					0.5f);
	gw_points points = scene_points(&sheet);
	points.normal = NULL;
	gw_bake_options options = gw_bake_options_default();
	gw_scene *made = NULL;
	gw_lighting *lighting = NULL;
	gw_error error = { 0 };
	float *radiance = calloc(3 * sheet.count, sizeof *radiance);
	assert_non_null(radiance);
	assert_ok(gw_scene_create(&(gw_scene_description){ .points = &points }, &options, NULL, &made,
							  &error),
			  &error);
	for (int east = 0; east < 2; east++) {
		const gw_light light = half_sky(east, pixels);
		assert_ok(gw_lighting_create(made, &light, 1, &lighting, &error), &error);
		assert_ok(gw_lighting_radiance(lighting, radiance, &error), &error);
		for (size_t i = 0; i < sheet.count; i++)
			assert_true(fabsf(radiance[3 * i] - 0.5f) < 0.05f);
		gw_lighting_destroy(&lighting);
	}
	gw_scene_destroy(&made);
	free(radiance);
	scene_clear(&sheet);
}

static void bad_arguments_are_refused(void **state)
{
	(void)state;
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	gw_points points = scene_points(&hall);
	gw_bake_options options = few_rays();
	gw_scene *made = NULL;
	gw_error error = { 0 };
	options.max_error = 0.1f;
	assert_int_equal(gw_scene_create(&(gw_scene_description){ .points = &points }, &options, NULL,
									 &made, &error),
					 GW_ERROR_USAGE);
	assert_null(made);
	options.max_error = 0.0f;
	options.estimate_points = 0;
	made = make(&hall, &options, NULL);
	gw_light lamp = scene_point_light(1.0, 1.0, 1.0, -1.0f);
	gw_lighting *lighting = NULL;
	gw_error_estimate estimate;
	assert_int_equal(gw_lighting_create(made, &lamp, 1, &lighting, &error), GW_ERROR_USAGE);
	assert_null(lighting);
	lamp.intensity[0] = lamp.intensity[1] = lamp.intensity[2] = 1.0f;
	assert_ok(gw_lighting_create(made, &lamp, 1, &lighting, &error), &error);
	assert_int_equal(gw_lighting_error(lighting, &estimate, &error), GW_ERROR_USAGE);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&made);
	scene_clear(&hall);
}

static void the_version_is_the_headers(void **state)
{
	(void)state;
	assert_string_equal(gw_version(), GW_VERSION);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_lighting_is_a_bake),
		cmocka_unit_test(lamps_come_and_go),
		cmocka_unit_test(emission_is_switched),
		cmocka_unit_test(lightings_stand_side_by_side),
		cmocka_unit_test(units_come_back),
		cmocka_unit_test(it_asks_and_tells_all_the_time),
		cmocka_unit_test(stopping_leaves_the_scene),
		cmocka_unit_test(either_side_of_a_sheet_is_lit),
		cmocka_unit_test(bad_arguments_are_refused),
		cmocka_unit_test(the_version_is_the_headers),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
