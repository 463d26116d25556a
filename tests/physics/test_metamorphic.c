/* Bakes compared with each other: what must change nothing, changes nothing; what must double,
 * doubles. No reference is needed, and most comparisons are of every bit. */
#include "scenes.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Relative spacing of half floats, which hold the light of the cones' voxels. */
#define HALF_ROUNDOFF 0x1p-11

#define LIGHTS 4

/* Lamps of the hall: one of each type, with and without extent. */
static void make_lights(gw_light lights[LIGHTS])
{
	lights[0] = scene_point_light(1.0, 2.0, 1.5, 3.0f);
	lights[0].radius = 0.0625f;
	lights[1] = scene_point_light(3.0, 0.5, 2.0, 6.0f);
	lights[1].type = GW_LIGHT_SPOT;
	lights[1].direction[1] = 1.0;
	lights[1].direction[2] = -1.0;
	lights[1].inner_angle = 10.0f;
	lights[1].outer_angle = 35.0f;
	lights[2] = (gw_light){ .type = GW_LIGHT_SUN,
							.direction = { 0.25, 1, -0.5 },
							.irradiance = { 4.0f, 3.5f, 3.0f } };
	lights[3] = (gw_light){ .type = GW_LIGHT_ENVIRONMENT, .radiance = { 0.3f, 0.4f, 0.6f } };
}

/* What holds between two bakes holds for any number of rays, cells and texels, so there are few. */
static gw_bake_options options_of(gw_method method)
{
	gw_bake_options options = gw_bake_options_default();
	options.method = method;
	options.rays = options.light_samples = 16;
	options.volume_cells = 8;
	options.probe_size = 8;
	options.bounces = 3;
	return options;
}

/* The hall and its lights, baked; its error is no light, and nothing compares it. */
static gw_bake_result *bake_hall(const scene *s, const gw_light *lights, size_t light_count,
								 gw_method method)
{
	gw_points points = scene_points(s);
	gw_bake_options options = options_of(method);
	options.estimate_points = 0;
	return scene_bake(&points, lights, light_count, &options);
}

/* Fails unless a[3 * i] == factor * b[3 * order[i]] in every bit; order NULL: the same order. */
static void assert_same(const char *what, const float *a, const float *b, float factor,
						const size_t *order, size_t count)
{
	size_t differing = 0;
	double worst = 0.0;
	for (size_t i = 0; i < count; i++) {
		size_t other = order ? order[i] : i;
		for (size_t c = 0; c < 3; c++) {
			float x = a[3 * i + c], y = factor * b[3 * other + c];
			differing += memcmp(&x, &y, sizeof x) != 0;
			worst = fmax(worst, fabs((double)x - (double)y));
		}
	}
	if (differing > 0)
		fail_msg("%s: %zu of %zu values differ, by up to %g", what, differing, 3 * count, worst);
}

static void assert_same_light(const gw_bake_result *a, const gw_bake_result *b, float factor,
							  const size_t *order)
{
	assert_same("direct irradiance", a->direct_irradiance, b->direct_irradiance, factor, order,
				a->count);
	assert_same("indirect irradiance", a->indirect_irradiance, b->indirect_irradiance, factor,
				order, a->count);
	assert_same("radiance", a->radiance, b->radiance, factor, order, a->count);
}

static void assert_finite(const gw_bake_result *result)
{
	const float *arrays[] = { result->radiance, result->direct_irradiance,
							  result->indirect_irradiance, result->albedo };
	for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++) {
		for (size_t i = 0; i < 3 * result->count; i++)
			assert_true(isfinite(arrays[a][i]) && arrays[a][i] >= 0.0f);
	}
	for (size_t i = 0; i < result->count; i++) {
		const float *n = &result->normal[3 * i];
		double length = sqrt((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
		/* Three squares, two sums and a root of float32. */
		assert_true(fabs(length - 1.0) <= 8 * 0x1p-24);
		assert_true(isfinite(result->roi[i]) && result->roi[i] >= 0.0f);
	}
}

typedef void compare(gw_method method, const scene *hall, const gw_light *lights,
					 const gw_bake_result *plain);

/* The hall as it is, by each method, with all effects: baked once for all comparisons. */
static gw_bake_result *plain_hall[GW_METHOD_COUNT];

static int forget_plain_hall(void **state)
{
	(void)state;
	for (int method = 0; method < GW_METHOD_COUNT; method++)
		gw_bake_result_destroy(&plain_hall[method]);
	return 0;
}

/* Hands the hall as each method bakes it to a comparison. */
static void with_hall(compare *run)
{
	for (int method = 0; method < GW_METHOD_COUNT; method++) {
		scene hall = { 0 };
		gw_light lights[LIGHTS];
		scene_make_small_hall(&hall);
		make_lights(lights);
		if (!plain_hall[method]) {
			gw_points points = scene_points(&hall);
			gw_bake_options options = options_of((gw_method)method);
			plain_hall[method] = scene_bake(&points, lights, LIGHTS, &options);
		}
		run((gw_method)method, &hall, lights, plain_hall[method]);
		scene_clear(&hall);
	}
}

static void brighten(gw_light *light, float factor)
{
	for (size_t c = 0; c < 3; c++) {
		light->intensity[c] *= factor;
		light->irradiance[c] *= factor;
		light->radiance[c] *= factor;
	}
}

/* ----------------------------------------------------------------------------- the same bits */

/* What is done to a hall and its lights that must change no bit, but for a factor. */
typedef struct changes {
	bool moved;    /* to coordinates of a map's grid, where float32 could not tell points apart */
	bool shuffled; /* the points */
	bool dark_lights; /* as many as there are, without power, which cost nothing on the device */
	float factor;     /* of all light, a power of two; 0: none */
	uint32_t threads;
} changes;

static void move(scene *s, gw_light lights[LIGHTS])
{
	const double by[3] = { 5e5, 5.4e6, 100 };
	for (size_t i = 0; i < 3 * s->count; i++)
		s->position[i] += by[i % 3];
	for (size_t i = 0; i < 3 * LIGHTS; i++)
		lights[i / 3].position[i % 3] += by[i % 3];
}

/* A copy of the hall; order receives where its points came from. */
static scene copy_hall(const scene *hall, bool shuffle, size_t *order)
{
	scene copy = { .state = 7, .emits = hall->emits };
	for (size_t i = 0; i < hall->count; i++) {
		size_t j = shuffle ? (size_t)(scene_random(&copy) * (double)(i + 1)) : i;
		order[i] = order[j];
		order[j] = i;
	}
	for (size_t i = 0; i < hall->count; i++) {
		const size_t from = 3 * order[i], bytes = 3 * sizeof(float);
		scene_add(&copy, &hall->position[from], (double[3]){ 0, 0, 1 }, 0.0f);
		memcpy(&copy.normal[3 * i], &hall->normal[from], bytes);
		memcpy(&copy.albedo[3 * i], &hall->albedo[from], bytes);
		memcpy(&copy.emission[3 * i], &hall->emission[from], bytes);
	}
	return copy;
}

static gw_bake_result *bake_changed(const scene *hall, const gw_light *lights, gw_method method,
									const changes *c, size_t *order)
{
	gw_light own[2 * LIGHTS];
	gw_bake_options options = options_of(method);
	scene changed = copy_hall(hall, c->shuffled, order);
	memcpy(own, lights, LIGHTS * sizeof *own);
	if (c->moved)
		move(&changed, own);
	for (size_t i = 0; i < LIGHTS && c->factor > 0.0f; i++)
		brighten(&own[i], c->factor);
	for (size_t i = 0; i < 3 * changed.count && c->factor > 0.0f; i++)
		changed.emission[i] *= c->factor;
	for (size_t i = 0; i < LIGHTS; i++) {
		own[LIGHTS + i] = lights[i];
		brighten(&own[LIGHTS + i], 0.0f);
	}
	const gw_points points = scene_points(&changed);
	options.threads = c->threads;
	options.estimate_points = 0;
	gw_bake_result *result =
		scene_bake(&points, own, c->dark_lights ? 2 * LIGHTS : LIGHTS, &options);
	scene_clear(&changed);
	return result;
}

static void expect_changed(const scene *hall, const gw_light *lights, gw_method method,
						   const changes *c, const gw_bake_result *plain)
{
	size_t *order = malloc(hall->count * sizeof *order);
	assert_non_null(order);
	gw_bake_result *result = bake_changed(hall, lights, method, c, order);
	assert_same_light(result, plain, c->factor > 0.0f ? c->factor : 1.0f, order);
	for (size_t i = 0; i < hall->count; i++)
		assert_true(result->roi[i] == plain->roi[order[i]]);
	/* How many dispatches a pass is cut into depends on time; for which lights there are passes
	 * does not. "3 of 6 lamps shine" is "3 of 3", without them. */
	assert_int_equal(atoi(scene_effect(&result->report, "lamps")->reason),
					 atoi(scene_effect(&plain->report, "lamps")->reason));
	gw_bake_result_destroy(&result);
	free(order);
}

/* Many at once, since a fault of one shows beside the others. */
static void compare_changed(gw_method method, const scene *hall, const gw_light *lights,
							const gw_bake_result *plain)
{
	const changes first = { .moved = true, .shuffled = true, .factor = 2.0f, .threads = 1 };
	/* Light whose squares and sums are no float32. */
	const changes second = { .dark_lights = true, .factor = 0x1p110f, .threads = 3 };
	expect_changed(hall, lights, method, &first, plain);
	expect_changed(hall, lights, method, &second, plain);
}

/* Places, order, threads, lights without power: no bit. All light times a power of two: exactly
 * that. */
static void changes_without_effect(void **state)
{
	(void)state;
	with_hall(compare_changed);
}

/* Each of them alone, by rays: says which one it is. */
static void compare_each(gw_method method, const scene *hall, const gw_light *lights,
						 const gw_bake_result *plain)
{
	const changes alone[] = { { .moved = true },       { .shuffled = true },
							  { .dark_lights = true }, { .factor = 2.0f },
							  { .factor = 0x1p110f },  { .threads = 1 },
							  { .threads = 3 },        { 0 } };
	for (size_t i = 0; method == GW_METHOD_RAYS && i < sizeof alone / sizeof *alone; i++)
		expect_changed(hall, lights, method, &alone[i], plain);
}

static void each_change_alone(void **state)
{
	(void)state;
	with_hall(compare_each);
}

static void compare_red(gw_method method, const scene *hall, const gw_light *lights,
						const gw_bake_result *plain)
{
	gw_light red[LIGHTS];
	memcpy(red, lights, sizeof red);
	for (size_t i = 0; i < LIGHTS; i++) {
		for (size_t c = 1; c < 3; c++)
			red[i].intensity[c] = red[i].irradiance[c] = red[i].radiance[c] = 0.0f;
	}
	for (size_t i = 0; i < 3 * hall->count; i++)
		hall->emission[i] *= i % 3 == 0 ? 1.0f : 0.0f;
	gw_bake_result *result = bake_hall(hall, red, LIGHTS, method);
	for (size_t i = 0; i < 3 * hall->count; i++) {
		if (i % 3 != 0)
			assert_true(result->radiance[i] == 0.0f && result->direct_irradiance[i] == 0.0f &&
						result->indirect_irradiance[i] == 0.0f);
	}
	assert_true(scene_mean(result->indirect_irradiance, hall->count, 0) >
				0.1 * scene_mean(plain->indirect_irradiance, hall->count, 0));
	gw_bake_result_destroy(&result);
}

static void red_light_stays_red(void **state)
{
	(void)state;
	with_hall(compare_red);
}

/* -------------------------------------------------------------------------- nearly the same */

static void assert_mean(const char *what, const float *a, const float *b, size_t count_a,
						size_t count_b, double relative)
{
	for (size_t c = 0; c < 3; c++) {
		double x = scene_mean(a, count_a, c), y = scene_mean(b, count_b, c);
		if (!(fabs(x - y) <= relative * fabs(y)))
			fail_msg("%s, channel %zu: mean %.7g, not %.7g: off by %.2g, allowed %.2g", what, c, x,
					 y, fabs(x / y - 1.0), relative);
	}
}

static void compare_duplicated(gw_method method, const scene *hall, const gw_light *lights,
							   const gw_bake_result *plain)
{
	scene twice = { 0 };
	for (size_t i = 0; i < 2 * hall->count; i++) {
		size_t from = i % hall->count;
		scene_add(&twice, &hall->position[3 * from], (double[3]){ 0, 0, 1 }, 0.0f);
		memcpy(&twice.normal[3 * i], &hall->normal[3 * from], 3 * sizeof(float));
		memcpy(&twice.albedo[3 * i], &hall->albedo[3 * from], 3 * sizeof(float));
		memcpy(&twice.emission[3 * i], &hall->emission[3 * from], 3 * sizeof(float));
	}
	twice.emits = true;
	gw_bake_result *result = bake_hall(&twice, lights, LIGHTS, method);
	/* 1 %: merging averages normals, which rounds them, and a ray may then just miss a plane. */
	assert_mean("duplicated", result->radiance, plain->radiance, twice.count, hall->count, 0.01);
	assert_mean("duplicated, indirect", result->indirect_irradiance, plain->indirect_irradiance,
				twice.count, hall->count, 0.01);
	gw_bake_result_destroy(&result);
	scene_clear(&twice);
}

/* Points at the place of others add nothing. */
static void duplicates_do_not_brighten(void **state)
{
	(void)state;
	with_hall(compare_duplicated);
}

static void compare_scaled_by(float scale, gw_method method, const scene *hall,
							  const gw_light *lights, const gw_bake_result *plain)
{
	gw_light scaled[LIGHTS];
	memcpy(scaled, lights, sizeof scaled);
	for (size_t i = 0; i < 3 * hall->count; i++)
		hall->position[i] *= (double)scale;
	for (size_t i = 0; i < LIGHTS; i++) {
		for (size_t k = 0; k < 3; k++) {
			scaled[i].position[k] *= (double)scale;
			scaled[i].intensity[k] *= scale * scale;
		}
		scaled[i].radius *= scale;
	}
	gw_bake_result *result = bake_hall(hall, scaled, LIGHTS, method);
	/* The scale is a power of two, so only what is rounded relative to whole metres differs: a
	 * few rays in 10^5 may pass on the other side of an edge. */
	assert_mean("scaled, direct", result->direct_irradiance, plain->direct_irradiance, hall->count,
				hall->count, 1e-4);
	assert_mean("scaled", result->radiance, plain->radiance, hall->count, hall->count, 1e-4);
	gw_bake_result_destroy(&result);
	for (size_t i = 0; i < 3 * hall->count; i++)
		hall->position[i] /= (double)scale;
}

/* In the small hall, areas in square metres would be no float32. */
static void compare_scaled(gw_method method, const scene *hall, const gw_light *lights,
						   const gw_bake_result *plain)
{
	compare_scaled_by(4.0f, method, hall, lights, plain);
	if (method == GW_METHOD_RAYS) /* units are chosen before methods see them */
		compare_scaled_by(0x1p-62f, method, hall, lights, plain);
}

/* Lengths times a factor and intensities times its square: the same irradiance. */
static void scale_of_the_scene(void **state)
{
	(void)state;
	with_hall(compare_scaled);
}

/* A hall so many metres long for each of its own that a lamp in it is too bright. */
static void expect_too_bright(double scale, float intensity)
{
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	for (size_t i = 0; i < 3 * hall.count; i++)
		hall.position[i] *= scale;
	gw_points points = scene_points(&hall);
	gw_light light = scene_point_light(2.0 * scale, 1.5 * scale, 0.5 * scale, intensity);
	gw_bake_options options = options_of(GW_METHOD_RAYS);
	gw_bake_result *result = NULL;
	gw_error error = { 0 };
	gw_status status =
		gw_bake(&(gw_scene_description){ &points, &light, 1 }, &options, NULL, &result, &error);
	if (status == GW_ERROR_NO_DEVICE)
		skip();
	assert_int_equal(status, GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "weaker lamps"));
	assert_null(result);
	scene_clear(&hall);
}

/* Light that is more than a float32 holds is an error with a sentence. */
static void light_beyond_numbers(void **state)
{
	(void)state;
	expect_too_bright(1.0, 3e38f);
	expect_too_bright(1e-300, 1.0f);
}

static void compare_sum(gw_method method, const scene *hall, const gw_light *lights,
						const gw_bake_result *plain)
{
	const gw_bake_result *both = plain;
	if (method == GW_METHOD_VOLUME)
		return; /* which holds irradiance above 0 and under what the brightest facets allow */
	gw_bake_result *a = bake_hall(hall, lights, 2, method);
	memset(hall->emission, 0, 3 * hall->count * sizeof *hall->emission);
	gw_bake_result *b = bake_hall(hall, lights + 2, LIGHTS - 2, method);
	double mean = scene_mean(both->radiance, hall->count, 1);
	/* Rays: float32 sums of up to 64 terms in four stages. Cones: radiance is rounded to half
	 * floats at the leaves and at each mipmap below the root, in each of two reflections. */
	double allowed = method == GW_METHOD_RAYS ? 1e-5 : 2.0 * both->report.depth * HALF_ROUNDOFF;
	for (size_t i = 0; i < 3 * hall->count; i++) {
		double sum = (double)a->radiance[i] + (double)b->radiance[i];
		double off = fabs((double)both->radiance[i] - sum);
		if (!(off <= allowed * fmax(mean, sum)))
			fail_msg("%s, point %zu: %.8g, not %.8g: off by %.2g of the mean, allowed %.2g",
					 gw_method_name(method), i / 3, (double)both->radiance[i], sum, off / mean,
					 allowed);
	}
	gw_bake_result_destroy(&a);
	gw_bake_result_destroy(&b);
}

/* Light of two groups of lamps, one with what glows, adds up, each with its shadows and
 * reflections. */
static void superposition(void **state)
{
	(void)state;
	with_hall(compare_sum);
}

/* Twice as many points a metre: the same room, so the same mean but for its edges. Of 30 points a
 * side they are, as wide as a leaf of 1.25 spacings, a sixth of the surface; where half of the
 * light is wrong there, that makes 8 %, which half as wide cells halve: 4 %. */
static void density_does_not_brighten(void **state)
{
	(void)state;
	for (int method = 0; method < GW_METHOD_COUNT; method++) {
		gw_light light = scene_point_light(1.2, 0.8, 1.1, 2.0f);
		gw_bake_result *result[2];
		scene s[2] = { { 0 }, { 0 } };
		for (size_t n = 0; n < 2; n++) {
			scene_add_box(&s[n], (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, n ? 30 : 15, 0.5f);
			result[n] = bake_hall(&s[n], &light, 1, (gw_method)method);
		}
		assert_mean(gw_method_name((gw_method)method), result[1]->indirect_irradiance,
					result[0]->indirect_irradiance, s[1].count, s[0].count, 0.04);
		for (size_t n = 0; n < 2; n++) {
			gw_bake_result_destroy(&result[n]);
			scene_clear(&s[n]);
		}
	}
}

/* ------------------------------------------------------------------- only what is called for */

/* Is an effect of the points themselves, which neither the box nor the hall call for, or one that
 * nobody asked for? */
static bool is_of_points(const gw_effect *effect)
{
	return strcmp(effect->name, "normals") == 0 || strcmp(effect->name, "noise") == 0 ||
		   strcmp(effect->name, "transmission") == 0 || strcmp(effect->name, "columns") == 0;
}

/* One reflection of a lamp: no records are placed, and no effect but direct light is computed. */
static void no_records_without_need(void **state)
{
	(void)state;
	const char *stages[] = { "records", "first gather", "bounces", "read back", "voxels" };
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 20, 0.5f);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(0.5, 0.5, 0.5, 1.0f);
	gw_bake_options options = options_of(GW_METHOD_RAYS);
	options.bounces = 1;
	gw_bake_result *result = scene_bake(&points, &light, 1, &options);
	for (size_t i = 0; i < sizeof stages / sizeof *stages; i++)
		assert_false(scene_has_stage(&result->report, stages[i]));
	assert_true(scene_has_stage(&result->report, "direct light"));
	assert_int_equal(result->report.records, 0);
	assert_int_equal(result->report.brick_bytes, 0);
	for (uint32_t i = 0; i < result->report.effect_count; i++) {
		const gw_effect *effect = &result->report.effect[i];
		bool gathers = strcmp(effect->name, "emitters") == 0 || strcmp(effect->name, "sky") == 0 ||
					   strcmp(effect->name, "portals") == 0 || strcmp(effect->name, "bounces") == 0;
		assert_int_equal(effect->called_for, !gathers && !is_of_points(effect));
		assert_true(effect->reason[0] != '\0');
		assert_int_equal(effect->method[0] != '\0', effect->called_for);
	}
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* Black walls reflect nothing, so bounces that are asked for do not run; nor does anything without
 * light. */
static void nothing_to_reflect(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 20, 0.0f);
	gw_light light = scene_point_light(0.5, 0.5, 0.5, 1.0f);
	gw_bake_result *black = bake_hall(&s, &light, 1, GW_METHOD_RAYS);
	assert_false(scene_has_stage(&black->report, "bounces"));
	assert_true(scene_mean(black->direct_irradiance, s.count, 0) > 0.0);
	gw_bake_result_destroy(&black);
	gw_bake_result *unlit = bake_hall(&s, NULL, 0, GW_METHOD_RAYS);
	assert_false(scene_has_stage(&unlit->report, "bounces"));
	for (size_t i = 0; i < 3 * s.count; i++)
		assert_true(unlit->radiance[i] == 0.0f);
	gw_bake_result_destroy(&unlit);
	scene_clear(&s);
}

/* The hall calls for all effects but portals, for which it is too open; each is reported and
 * computed. */
static void compare_effects(gw_method method, const scene *hall, const gw_light *lights,
							const gw_bake_result *plain)
{
	(void)lights;
	assert_true(plain->report.effect_count >= 4);
	for (uint32_t i = 0; i < plain->report.effect_count; i++) {
		const gw_effect *effect = &plain->report.effect[i];
		if (effect->called_for == (is_of_points(effect) || strcmp(effect->name, "portals") == 0))
			fail_msg("%s is%s called for: %s", effect->name, effect->called_for ? "" : " not",
					 effect->reason);
	}
	assert_true(plain->report.records > 0);
	assert_int_equal(plain->report.brick_bytes > 0, method == GW_METHOD_CONES);
	assert_true(scene_mean(plain->indirect_irradiance, hall->count, 1) > 0.0);
	assert_finite(plain);
}

static void all_effects(void **state)
{
	(void)state;
	with_hall(compare_effects);
}

/* Probes have no room among so few, and that is said. */
static void no_room_for_probes(const gw_points *points, const gw_light *lights,
							   const gw_bake_options *options)
{
	const gw_scene_description few = { points, lights, LIGHTS };
	gw_bake_result *result = NULL;
	gw_error error = { 0 };
	assert_int_equal(gw_bake(&few, options, NULL, &result, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "no free space for a probe"));
	assert_null(result);
}

/* Clouds of one, two and three points are odd but no fault. */
static void few_points(void **state)
{
	(void)state;
	gw_light lights[LIGHTS];
	make_lights(lights);
	for (int method = 0; method < GW_METHOD_COUNT; method++) {
		for (size_t n = 1; n <= 3; n++) {
			scene s = { 0 };
			for (size_t i = 0; i < n; i++)
				scene_add(&s, (double[3]){ (double)i, 0.25 * (double)(i * i), 0 },
						  (double[3]){ 0, 0, 1 }, 0.5f);
			scene_emit(&s, n - 1, (float[3]){ 1, 1, 1 });
			gw_points points = scene_points(&s);
			gw_bake_options options = gw_bake_options_default();
			options.method = (gw_method)method;
			for (int normals = 0; normals < 2; normals++) {
				points.normal = normals ? s.normal : NULL;
				if (method == GW_METHOD_PROBES) {
					no_room_for_probes(&points, lights, &options);
					continue;
				}
				gw_bake_result *result = scene_bake(&points, lights, LIGHTS, &options);
				assert_finite(result);
				assert_true(result->direct_irradiance[0] > 0.0f);
				gw_bake_result_destroy(&result);
			}
			scene_clear(&s);
		}
	}
}

/* -------------------------------------------------------------------------------- validation */

/* A bake under Vulkan's validation layer, which makes any message an error. */
static void validated(void **state)
{
	(void)state;
	for (int method = 0; method < GW_METHOD_COUNT; method++) {
		scene hall = { 0 };
		gw_light lights[LIGHTS];
		gw_bake_result *result;
		gw_error error = { 0 };
		scene_make_small_hall(&hall);
		make_lights(lights);
		gw_points points = scene_points(&hall);
		gw_bake_options options = options_of((gw_method)method);
		options.validate = GW_VALIDATE_CALLS;
		scene_choose_passes(&options.passes, &options.validate);
		options.voxels = true;
		gw_status status = gw_bake(&(gw_scene_description){ &points, lights, LIGHTS }, &options,
								   NULL, &result, &error);
		scene_clear(&hall);
		assert_ok_validated(status, &error);
		assert_true(result->voxels.count > 0);
		gw_bake_result_destroy(&result);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(changes_without_effect),
		cmocka_unit_test(each_change_alone),
		cmocka_unit_test(red_light_stays_red),
		cmocka_unit_test(duplicates_do_not_brighten),
		cmocka_unit_test(scale_of_the_scene),
		cmocka_unit_test(light_beyond_numbers),
		cmocka_unit_test(superposition),
		cmocka_unit_test(density_does_not_brighten),
		cmocka_unit_test(no_records_without_need),
		cmocka_unit_test(nothing_to_reflect),
		cmocka_unit_test(all_effects),
		cmocka_unit_test(few_points),
		cmocka_unit_test(validated),
	};
	return cmocka_run_group_tests(tests, NULL, forget_plain_hall);
}
