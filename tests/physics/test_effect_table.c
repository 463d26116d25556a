/*
 * test_effect_table.c - of effects that have no passes of their own: forbidden, the device does
 * what it does for a scene that does not call for them, to the byte; forced without need, they
 * change no light; and by how much the light differs without them.
 */
#include "cloud/surfels.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIDE 32 /* points a side of the floor, 1 m wide */

static const uint32_t transmission = 1u << GW_EFFECT_TRANSMISSION;
static const uint32_t noise = 1u << GW_EFFECT_NOISE;
static const uint32_t columns = 1u << GW_EFFECT_COLUMNS;

static gw_bake_options coarse(void)
{
	gw_bake_options options = gw_bake_options_default();
	gw_bake_options_set_quality(&options, GW_QUALITY_DRAFT);
	return options;
}

static const gw_light sun = { .type = GW_LIGHT_SUN,
							  .direction = { 0, 0, -1 },
							  .irradiance = { 1.0f, 1.0f, 1.0f } };

static void make_floor(scene *s)
{
	scene_add_patch(s,
					&(scene_patch){ (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 },
									(double[]){ 0, 1, 0 }, SIDE, SIDE },
					0.5f);
}

/* A floor, and half a metre over it a sheet twice as wide. */
static void make_roofed_floor(scene *s)
{
	make_floor(s);
	scene_add_patch(s,
					&(scene_patch){ (double[]){ -0.5, -0.5, 0.5 }, (double[]){ 0, 2, 0 },
									(double[]){ 2, 0, 0 }, 2 * SIDE, 2 * SIDE },
					0.5f);
}

static void assert_same_light(const gw_bake_result *a, const gw_bake_result *b)
{
	assert_int_equal(a->count, b->count);
	assert_memory_equal(a->radiance, b->radiance, 3 * a->count * sizeof *a->radiance);
	assert_memory_equal(a->indirect_irradiance, b->indirect_irradiance,
						3 * a->count * sizeof *a->radiance);
}

/* The same passes as often, the same stages with as many dispatches and, from the octree on, bytes.
 */
static void assert_same_work(const gw_report *a, const gw_report *b)
{
	assert_int_equal(a->pass_count, b->pass_count);
	for (uint32_t i = 0; i < a->pass_count; i++) {
		assert_string_equal(a->pass[i].name, b->pass[i].name);
		assert_int_equal(a->pass[i].runs, b->pass[i].runs);
		assert_int_equal(a->pass[i].compiled, b->pass[i].compiled);
	}
	assert_int_equal(a->stage_count, b->stage_count);
	for (uint32_t i = 0; i < a->stage_count; i++) {
		assert_string_equal(a->stage[i].name, b->stage[i].name);
		/* Runs are cut into dispatches by how long they take. */
		assert_int_equal(a->stage[i].dispatches == 0, b->stage[i].dispatches == 0);
		if (a->stage[i].bytes > 0)
			assert_int_equal(a->stage[i].bytes, b->stage[i].bytes);
	}
	assert_int_equal(a->peak_bytes, b->peak_bytes);
	assert_int_equal(a->octree_bytes, b->octree_bytes);
	assert_int_equal(a->brick_bytes, b->brick_bytes);
}

/* ------------------------------------------------------------------------------ transmission */

/* A roof of opacity 0.3 lets 0.7 of the sun through, and one that is taken for opaque nothing. Then
 * no more is done than for points without an opacity; nor where all of them have one of 1. */
static void clear_or_not(void **state)
{
	(void)state;
	scene s = { 0 };
	make_roofed_floor(&s);
	float *opacity = malloc(2 * s.count * sizeof *opacity), *solid = opacity + s.count;
	for (size_t i = 0; i < s.count; i++) {
		opacity[i] = i < SIDE * SIDE ? 1.0f : 0.3f;
		solid[i] = 1.0f;
	}
	gw_points plain = scene_points(&s), clear = plain, whole = plain;
	clear.opacity = opacity;
	whole.opacity = solid;
	gw_bake_options options = coarse(), without = options;
	without.effects_forbidden = transmission;
	gw_bake_result *wanted = scene_bake(&clear, &sun, 1, &options);
	gw_bake_result *off = scene_bake(&clear, &sun, 1, &without);
	gw_bake_result *opaque = scene_bake(&plain, &sun, 1, &options);
	gw_bake_result *ones = scene_bake(&whole, &sun, 1, &options);
	/* 1 - 0.3 in float32, of which the tree keeps 16 bits behind the point. */
	double through = scene_mean(wanted->direct_irradiance, SIDE * SIDE, 0);
	assert_true(fabs(through - 0.7) < ldexp(1.0, -15));
	assert_true(scene_mean(off->direct_irradiance, SIDE * SIDE, 0) == 0.0);
	assert_same_light(off, opaque);
	assert_same_work(&off->report, &opaque->report);
	assert_same_light(ones, opaque);
	assert_same_work(&ones->report, &opaque->report);
	gw_bake_result_destroy(&wanted);
	gw_bake_result_destroy(&off);
	gw_bake_result_destroy(&opaque);
	gw_bake_result_destroy(&ones);
	free(opacity);
	scene_clear(&s);
}

/* ------------------------------------------------------------------------------------- noise */

/* A floor whose points scatter by 0.3 of their spacing, and whose normals lean by 10 degrees to all
 * sides. */
static void make_rough_floor(scene *s)
{
	make_floor(s);
	const double lean = 10.0 * SCENE_PI / 180.0;
	for (size_t i = 0; i < s->count; i++) {
		double around = 2.0 * SCENE_PI * scene_random(s);
		double height = scene_random(s) + scene_random(s) + scene_random(s) - 1.5;
		s->position[3 * i + 2] += 0.3 * 2.0 * height / SIDE; /* the sum of three has 1/2 */
		s->normal[3 * i] = (float)(sin(lean) * cos(around));
		s->normal[3 * i + 1] = (float)(sin(lean) * sin(around));
		s->normal[3 * i + 2] = (float)cos(lean);
	}
}

/* Where noise is not smoothed, each normal is the one that was given: cos 10 degrees of the sun.
 * Smoothed, it is the mean of some 30 around it, of which a thirtieth of the noise is left: at
 * least nine tenths of what was missing come back. */
static void smoothed_or_not(void **state)
{
	(void)state;
	scene s = { 0 };
	make_rough_floor(&s);
	gw_points points = scene_points(&s);
	gw_bake_options options = coarse();
	options.bounces = 1;
	options.shadows = GW_SHADOWS_NONE;
	gw_bake_result *smooth = scene_bake(&points, &sun, 1, &options);
	options.effects_forbidden = noise;
	gw_bake_result *rough = scene_bake(&points, &sun, 1, &options);
	double lost = 1.0 - cos(10.0 * SCENE_PI / 180.0);
	/* Three roundings of a normal, and one of its product. */
	assert_true(fabs(scene_mean(rough->direct_irradiance, s.count, 0) - (1.0 - lost)) <
				4.0 * ldexp(1.0, -24));
	double left = 1.0 - scene_mean(smooth->direct_irradiance, s.count, 0);
	assert_true(left > 0.0 && left < 0.1 * lost);
	scene_clear(&s);
	make_floor(&s);
	points = scene_points(&s);
	options.effects_forbidden = 0;
	gw_bake_result *even = scene_bake(&points, &sun, 1, &options);
	assert_same_work(&rough->report, &even->report);
	assert_true(smooth->report.pass[0].runs > rough->report.pass[0].runs);
	gw_bake_result_destroy(&even);
	gw_bake_result_destroy(&smooth);
	gw_bake_result_destroy(&rough);
	scene_clear(&s);
}

/* What is smoothed stands beside what was given; nothing does where it is forbidden, or not called
 * for. */
static void no_bytes_for_noise(void **state)
{
	(void)state;
	for (int rough = 0; rough < 2; rough++)
		for (int forbidden = 0; forbidden < 2; forbidden++) {
			scene s = { 0 };
			rough ? make_rough_floor(&s) : make_floor(&s);
			gw_points points = scene_points(&s);
			const gw_surfels_options options = { .threads = 1,
												 .effects_forbidden = forbidden ? noise : 0 };
			gw_surfels surfels;
			gw_error error;
			assert_int_equal(gw_surfels_make(&points, &options, &surfels, &error), GW_OK);
			assert_true((surfels.shading_normal != NULL) == (rough && !forbidden));
			gw_surfels_clear(&surfels);
			scene_clear(&s);
		}
}

/* ----------------------------------------------------------------------------------- columns */

/* The light of each of two lamps, which only costs anything where it is asked for: then passes run
 * again for each of them. The columns add up to the whole: three sums of float32 numbers. */
static void columns_or_not(void **state)
{
	(void)state;
	scene s = { 0 };
	make_roofed_floor(&s);
	gw_points points = scene_points(&s);
	const gw_light lamp[] = { scene_point_light(0.2, 0.3, 0.3, 1.0f),
							  scene_point_light(0.8, 0.6, 0.2, 0.5f) };
	gw_bake_options options = coarse(), forbidden = options, forced = options;
	forbidden.effects_forbidden = columns;
	forced.effects_forced = columns;
	options.bounces = forbidden.bounces = forced.bounces = 3;
	gw_bake_result *plain = scene_bake(&points, lamp, 2, &options);
	gw_bake_result *off = scene_bake(&points, lamp, 2, &forbidden);
	gw_bake_result *on = scene_bake(&points, lamp, 2, &forced);
	assert_null(plain->lamp);
	assert_null(off->lamp);
	assert_same_work(&plain->report, &off->report);
	assert_same_light(plain, off);
	assert_same_light(plain, on);
	assert_non_null(on->lamp);
	for (size_t i = 0; i < 3 * s.count; i++) {
		double whole = (double)on->radiance[i], sum = 0.0;
		for (size_t k = 0; k < 2; k++)
			sum += (double)on->lamp[k][i];
		assert_true(fabs(sum - whole) <= 8.0 * ldexp(1.0, -24) * whole);
	}
	gw_bake_result_destroy(&plain);
	gw_bake_result_destroy(&off);
	gw_bake_result_destroy(&on);
	scene_clear(&s);
}

/* ----------------------------------------------------------------- what tells, and what finds */

/* The estimated error and holes of the surface say of light how wrong it is: without them it is the
 * same, to the byte. */
static void light_is_the_same(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_make_cellar(&s);
	gw_points points = scene_points(&s);
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_options options = coarse();
	gw_bake_result *plain = scene_bake(&points, &sky, 1, &options);
	const gw_effect_kind effect[] = { GW_EFFECT_ERROR, GW_EFFECT_GAPS };
	for (size_t i = 0; i < 2; i++) {
		options.effects_forbidden = 1u << effect[i];
		gw_bake_result *without = scene_bake(&points, &sky, 1, &options);
		assert_same_light(without, plain);
		assert_false(scene_has_stage(&without->report, i ? "gaps" : "estimate"));
		gw_bake_result_destroy(&without);
	}
	gw_bake_result_destroy(&plain);
	scene_clear(&s);
}

/* The mean irradiance of the cellar's floor under a sky of 1, and how much it scatters around what
 * a small hole of its width in a ceiling 1 m high sends there: the fourth power of the cosine. */
static double light_of_hole(const scene *s, const gw_bake_result *r, double *scatter)
{
	const size_t count = (size_t)SIDE * SIDE;
	double shape[SIDE * SIDE], of_shape = 0.0, square = 0.0;
	double found = scene_mean(r->direct_irradiance, count, 0);
	for (size_t i = 0; i < count; i++) {
		double x = s->position[3 * i] - 0.5, y = s->position[3 * i + 1] - 0.5;
		shape[i] = 1.0 / ((1.0 + x * x + y * y) * (1.0 + x * x + y * y));
		of_shape += shape[i] / (double)count;
	}
	for (size_t i = 0; i < count; i++) {
		double off = (double)r->direct_irradiance[3 * i] / found - shape[i] / of_shape;
		square += off * off;
	}
	*scatter = sqrt(square / (double)count);
	return found;
}

static uint64_t runs_of(const gw_report *report, const char *pass)
{
	for (uint32_t i = 0; i < report->pass_count; i++)
		if (strcmp(report->pass[i].name, pass) == 0)
			return report->pass[i].runs;
	return 0;
}

/*
 * Without portals the same light comes with more noise. They are neither looked for nor sampled
 * then, and of a record's K rays the share q that finds the hole is left to tell of it, so that it
 * is off by 1 / sqrt(K q), here 1.15; by portals eleven of its 32 samples do, which makes 0.3. Four
 * to sixteen records speak for a point. A sixth of all records lies on the floor, at least 200: the
 * mean is off by 1.15 / sqrt(200), 8 %, of which three are allowed.
 */
static void portals_or_not(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_make_cellar(&s);
	gw_points points = scene_points(&s);
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_options options = gw_bake_options_default(), without = options;
	options.bounces = without.bounces = 1;
	without.effects_forbidden = 1u << GW_EFFECT_PORTALS;
	gw_bake_result *on = scene_bake(&points, &sky, 1, &options);
	gw_bake_result *off = scene_bake(&points, &sky, 1, &without);
	double little, much, light = light_of_hole(&s, on, &little);
	double same = light_of_hole(&s, off, &much);
	double ray_noise = 1.0 / sqrt((double)without.rays * light / SCENE_PI);
	assert_true(on->report.records >= 1200);
	assert_true(runs_of(&on->report, "portal_light") > 0);
	assert_int_equal(runs_of(&off->report, "portal_light"), 0);
	assert_int_equal(runs_of(&off->report, "record_portals"), 0);
	if (!(fabs(same / light - 1.0) < 0.24 && much > ray_noise / 4.0 && much < ray_noise / 2.0 &&
		  little < 0.5 * much))
		fail_msg("light %g and %g, scatter %g and %g of %g", light, same, little, much, ray_noise);
	gw_bake_result_destroy(&on);
	gw_bake_result_destroy(&off);
	scene_clear(&s);
}

/* ------------------------------------------------------------------------------ light and shade */

/* A cellar under a hole in the ground, in which a patch glows and a lamp shines. */
static void make_lit_cellar(scene *s)
{
	scene_make_cellar(s);
	size_t first = s->count;
	scene_add_patch(s,
					&(scene_patch){ (double[]){ 0.6, 0.6, 0.3 }, (double[]){ 0, 0.2, 0 },
									(double[]){ 0.2, 0, 0 }, 6, 6 },
					0.5f);
	scene_emit(s, first, (float[]){ 1, 1, 1 });
}

/* The bake of the cellar without an effect: because it is forbidden, or because there is nothing to
 * call for it. */
static gw_bake_result *bake_without(const scene *s, gw_effect_kind effect, bool forbidden)
{
	gw_points points = scene_points(s);
	const gw_light lights[] = { { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } },
								scene_point_light(0.3, 0.3, 0.5, 1.0f) };
	const gw_light *first = lights;
	size_t count = 2;
	gw_bake_options options = coarse();
	options.bounces = 3;
	if (forbidden)
		options.effects_forbidden = 1u << effect;
	else if (effect == GW_EFFECT_LAMPS)
		count = 1;
	else if (effect == GW_EFFECT_SKY)
		first++, count = 1;
	else if (effect == GW_EFFECT_EMITTERS)
		points.emission = NULL;
	else if (effect == GW_EFFECT_SHADOWS)
		options.shadows = GW_SHADOWS_NONE;
	else if (effect == GW_EFFECT_BOUNCES)
		options.bounces = 1;
	else
		options.estimate_points = 0;
	return scene_bake(&points, first, count, &options);
}

/* What is forbidden takes what nothing takes that nothing calls for: no pass, no shader, no byte.
 * Points that emit still show it themselves. */
static void as_if_nothing_called(void **state)
{
	(void)state;
	const gw_effect_kind effect[] = { GW_EFFECT_LAMPS,   GW_EFFECT_SKY,     GW_EFFECT_EMITTERS,
									  GW_EFFECT_SHADOWS, GW_EFFECT_BOUNCES, GW_EFFECT_ERROR };
	scene s = { 0 };
	make_lit_cellar(&s);
	for (size_t i = 0; i < sizeof effect / sizeof *effect; i++) {
		gw_bake_result *forbidden = bake_without(&s, effect[i], true);
		gw_bake_result *not_there = bake_without(&s, effect[i], false);
		assert_false(scene_effect(&forbidden->report, gw_effect_name(effect[i]))->called_for);
		assert_same_work(&forbidden->report, &not_there->report);
		/* What emits shows in the radiance of its own points. */
		assert_memory_equal(forbidden->indirect_irradiance, not_there->indirect_irradiance,
							3 * s.count * sizeof(float));
		assert_memory_equal(forbidden->direct_irradiance, not_there->direct_irradiance,
							3 * s.count * sizeof(float));
		gw_bake_result_destroy(&forbidden);
		gw_bake_result_destroy(&not_there);
	}
	scene_clear(&s);
}

typedef struct bytes {
	unsigned char *data;
	size_t length;
} bytes;

static gw_status keep(void *user, const void *data, size_t length, gw_error *error)
{
	bytes *to = user;
	(void)error;
	to->data = realloc(to->data, to->length + length);
	assert_non_null(to->data);
	memcpy(to->data + to->length, data, length);
	to->length += length;
	return GW_OK;
}

/* A transport that was made where emitters are forbidden lights by them where they are not, and the
 * other way round, as a bake does: to the byte without them, and with them but for the mean
 * emission of facets, which is added up in another order. What it holds of them is 16 bytes a
 * facet, of which each leaf has one at least. */
static void emitters_of_transports(void **state)
{
	(void)state;
	scene s = { 0 };
	make_lit_cellar(&s);
	gw_points points = scene_points(&s);
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } };
	bytes kept[2] = { { NULL, 0 } };
	gw_bake_result *first[2];
	gw_bake_options options[2] = { coarse(), coarse() };
	options[1].effects_forbidden = 1u << GW_EFFECT_EMITTERS;
	for (size_t i = 0; i < 2; i++) {
		gw_transport transport = { .name = "transport", .write = keep, .user = &kept[i] };
		options[i].transport = &transport;
		first[i] = scene_bake(&points, &sky, 1, &options[i]);
	}
	for (size_t i = 0; i < 2; i++) {
		gw_transport transport = { .name = "transport",
								   .data = kept[1 - i].data,
								   .length = kept[1 - i].length };
		options[i].transport = &transport;
		gw_bake_result *again = scene_bake(&points, &sky, 1, &options[i]);
		if (i == 1)
			assert_same_light(first[i], again);
		for (size_t k = 0; k < 3 * s.count; k++)
			assert_true(fabsf(first[i]->radiance[k] - again->radiance[k]) <= 1e-5f);
		gw_bake_result_destroy(&again);
	}
	assert_true(kept[0].length >= kept[1].length + 16 * (uint64_t)first[0]->report.leaves);
	for (size_t i = 0; i < 2; i++) {
		gw_bake_result_destroy(&first[i]);
		free(kept[i].data);
	}
	scene_clear(&s);
}

/* Bakes by single samples: their mean tells a loss of three in a hundred. */
#define ROUNDS 64

/* Mean irradiance of a floor below a long strip that glows. */
static double light_of_strip(uint32_t samples, uint64_t seed)
{
	scene s = { 0 };
	scene_add_patch(&s,
					&(scene_patch){ (double[]){ 0, 0, 0 }, (double[]){ 3, 0, 0 },
									(double[]){ 0, 1, 0 }, 90, 30 },
					0.0f);
	size_t floor = s.count;
	scene_add_patch(&s,
					&(scene_patch){ (double[]){ 0, 0.45, 0.2 }, (double[]){ 0, 0.1, 0 },
									(double[]){ 3, 0, 0 }, 3, 90 },
					0.0f);
	scene_emit(&s, floor, (float[]){ 1, 1, 1 });
	gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	options.bounces = 1;
	options.rays = samples;
	options.light_samples = samples;
	options.seed = seed;
	options.estimate_points = 0;
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	double mean = scene_mean(result->direct_irradiance, floor, 0) +
				  scene_mean(result->indirect_irradiance, floor, 0);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
	return mean;
}

/* Most samples of a long strip are far from each record, and seldom asked whether they are seen:
 * what they bring must not get lost. A single one is always asked; of as many rays as samples the
 * weights are the same, however many these are, and so is what is expected. */
static void seldom_asked_samples(void **state)
{
	(void)state;
	double many = light_of_strip(64, 0), sum = 0.0, squares = 0.0;
	for (uint64_t seed = 1; seed <= ROUNDS; seed++) {
		double single = light_of_strip(1, seed);
		sum += single / ROUNDS;
		squares += single * single / ROUNDS;
	}
	double spread = sqrt((squares - sum * sum) / (ROUNDS - 1));
	print_message("strip: %.4f, by single samples %.4f +- %.4f\n", many, sum, spread);
	assert_true(spread < 0.01 * sum);
	assert_true(fabs(many - sum) < 4.0 * spread);
}

/* ------------------------------------------------------------------------------------ motion */

/* Frames in which nothing moves: none of them after the first builds anything anew, or traces a
 * ray, and its light is the first one's to the byte. */
static void frames_that_stand_still(void **state)
{
	(void)state;
	scene s = { 0 };
	make_roofed_floor(&s);
	gw_points points = scene_points(&s);
	const gw_light lamp = scene_point_light(0.2, 0.3, 0.3, 1.0f);
	const gw_motion motion = { .frame_count = 2 };
	gw_bake_options options = coarse();
	scene_choose_passes(&options.passes, &options.validate);
	gw_frames *frames = NULL;
	gw_bake_result *result[2];
	gw_error error;
	assert_int_equal(gw_frames_open(&(gw_moving_scene){ { &points, &lamp, 1 }, &motion }, &options,
									&(gw_frames_options){ .independent = true }, NULL, &frames,
									&error),
					 GW_OK);
	for (size_t f = 0; f < 2; f++)
		assert_int_equal(gw_frames_bake(frames, f, &lamp, 1, &result[f], &error), GW_OK);
	assert_same_light(result[0], result[1]);
	assert_true(result[0]->report.rays_traced > 0);
	assert_int_equal(result[1]->report.rays_traced, 0);
	assert_false(scene_has_stage(&result[1]->report, "octree"));
	gw_bake_result_destroy(&result[0]);
	gw_bake_result_destroy(&result[1]);
	gw_frames_close(&frames);
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clear_or_not),         cmocka_unit_test(smoothed_or_not),
		cmocka_unit_test(no_bytes_for_noise),   cmocka_unit_test(columns_or_not),
		cmocka_unit_test(light_is_the_same),    cmocka_unit_test(portals_or_not),
		cmocka_unit_test(as_if_nothing_called), cmocka_unit_test(emitters_of_transports),
		cmocka_unit_test(seldom_asked_samples), cmocka_unit_test(frames_that_stand_still),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
