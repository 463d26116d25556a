/*
 * test_effects.c - what a scene does not call for is not computed, what is forbidden neither, and
 * what is forced without need changes nothing.
 */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static gw_bake_options coarse(void)
{
	gw_bake_options options = gw_bake_options_default();
	gw_bake_options_set_quality(&options, GW_QUALITY_DRAFT);
	return options;
}

/* A cube open at the top; all walls of one albedo. */
static void make_yard(scene *s, float albedo)
{
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0, 0, 0 }, (double[3]){ 1, 0, 0 },
									(double[3]){ 0, 1, 0 }, 16, 16 },
					albedo);
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0, 0, 0 }, (double[3]){ 0, 1, 0 },
									(double[3]){ 0, 0, 1 }, 16, 16 },
					albedo);
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0, 0, 0 }, (double[3]){ 0, 0, 1 },
									(double[3]){ 1, 0, 0 }, 16, 16 },
					albedo);
}

static gw_light spot(double x, double y, double z, double down)
{
	gw_light light = scene_point_light(x, y, z, 3.0f);
	light.type = GW_LIGHT_SPOT;
	light.direction[2] = down;
	light.inner_angle = 20.0f;
	light.outer_angle = 40.0f;
	return light;
}

static uint64_t dispatches_of(const gw_report *report, const char *stage)
{
	uint64_t dispatches = 0;
	for (uint32_t i = 0; i < report->stage_count; i++)
		if (strcmp(report->stage[i].name, stage) == 0)
			dispatches += report->stage[i].dispatches;
	return dispatches;
}

static const gw_pass_count *pass_of(const gw_report *report, const char *name)
{
	for (uint32_t i = 0; i < report->pass_count; i++)
		if (strcmp(report->pass[i].name, name) == 0)
			return &report->pass[i];
	return NULL;
}

static void assert_same_light(const gw_bake_result *a, const gw_bake_result *b)
{
	assert_int_equal(a->count, b->count);
	assert_memory_equal(a->radiance, b->radiance, 3 * a->count * sizeof *a->radiance);
	assert_memory_equal(a->direct_irradiance, b->direct_irradiance,
						3 * a->count * sizeof *a->radiance);
	assert_memory_equal(a->indirect_irradiance, b->indirect_irradiance,
						3 * a->count * sizeof *a->radiance);
}

/* ------------------------------------------------------------------------- without an octree */

/* A lamp that nothing hides and nothing reflects: no tree is built, no shader runs but its own, and
 * the light is I cos / d^2 to the float32 numbers that it is computed with. */
static void no_octree_without_need(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(0.5, 0.5, 0.75, 2.0f);
	gw_bake_options options = coarse();
	options.effects_forbidden = 1u << GW_EFFECT_SHADOWS | 1u << GW_EFFECT_BOUNCES;
	gw_bake_result *r = scene_bake(&points, &light, 1, &options);
	assert_false(scene_effect(&r->report, "octree")->called_for);
	assert_int_equal(r->report.leaves, 0);
	assert_int_equal(dispatches_of(&r->report, "octree"), 0);
	assert_int_equal(r->report.pass_count, 1);
	assert_string_equal(r->report.pass[0].name, "light_irradiance");
	assert_false(scene_has_stage(&r->report, "gaps"));
	assert_false(scene_has_stage(&r->report, "records"));
	for (size_t i = 0; i < s.count; i++) {
		double to[3], square = 0.0, cosine = 0.0;
		for (int k = 0; k < 3; k++) {
			to[k] = light.position[k] - s.position[3 * i + (size_t)k];
			square += to[k] * to[k];
			cosine += to[k] * (double)s.normal[3 * i + (size_t)k];
		}
		double expected = 2.0 * fmax(cosine, 0.0) / (square * sqrt(square));
		/* Coordinates below 1 are rounded by 2^-25 and so are those of the lamp: the distance d by
		 * 2^-24 an axis, I cos / d^2 by thrice its share of d; and five operations follow. */
		double off = (3.0 * sqrt(3.0) / sqrt(square) + 5.0) * ldexp(1.0, -24);
		double cosine_off = 2.0 * sqrt(3.0) * ldexp(1.0, -24) / (square * sqrt(square));
		assert_true(fabs((double)r->direct_irradiance[3 * i] - expected) <=
					off * expected + cosine_off);
	}
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* Without lamps there is nothing of theirs; without any light, nothing at all. */
static void nothing_without_light(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	gw_points points = scene_points(&s);
	gw_bake_options options = coarse();
	gw_bake_result *r = scene_bake(&points, NULL, 0, &options);
	static const char *const stage[] = { "gaps",         "octree",  "direct light", "records",
										 "first gather", "bounces", "estimate",     "forecast" };
	for (size_t i = 0; i < sizeof stage / sizeof *stage; i++)
		assert_false(scene_has_stage(&r->report, stage[i]));
	assert_int_equal(r->report.peak_bytes, 0);
	assert_int_equal(r->report.pass_count, 0);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* Scenes whose lights are not known yet are made without what none of them may call for, and lit as
 * by one bake. */
static void scenes_for_bare_lamps(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(0.5, 0.5, 0.75, 2.0f);
	const gw_scene_description described = { &points, &light, 1 };
	gw_bake_options options = coarse();
	options.effects_forbidden = 1u << GW_EFFECT_SHADOWS | 1u << GW_EFFECT_BOUNCES |
								1u << GW_EFFECT_EMITTERS | 1u << GW_EFFECT_SKY;
	for (int shadows = 0; shadows < 2; shadows++) {
		gw_scene *handle = NULL;
		gw_lighting *lighting = NULL;
		gw_bake_result *lit = NULL, *baked = scene_bake(&points, &light, 1, &options);
		gw_error error = { 0 };
		assert_int_equal(gw_scene_create(&described, &options, NULL, &handle, &error), GW_OK);
		assert_int_equal(gw_lighting_create(handle, &light, 1, &lighting, &error), GW_OK);
		assert_int_equal(gw_lighting_result(lighting, &lit, &error), GW_OK);
		assert_same_light(lit, baked);
		assert_true((lit->report.leaves > 0) == shadows);
		assert_true((pass_of(&lit->report, "octree_fragments") != NULL) == shadows);
		assert_null(pass_of(&lit->report, "record_rays"));
		assert_false(scene_has_stage(&lit->report, "records"));
		gw_bake_result_destroy(&lit);
		gw_bake_result_destroy(&baked);
		gw_lighting_destroy(&lighting);
		gw_scene_destroy(&handle);
		options.effects_forbidden &= ~(1u << GW_EFFECT_SHADOWS);
	}
	scene_clear(&s);
}

/* A cellar under a hole in the ground, in which a patch glows and two lamps shine, under a sky that
 * is a map: it calls for all that has passes. */
static void make_cellar(scene *s, gw_light lights[3], const float *map)
{
	scene_make_cellar(s);
	size_t first = s->count;
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0.6, 0.6, 0.3 }, (double[3]){ 0, 0.2, 0 },
									(double[3]){ 0.2, 0, 0 }, 6, 6 },
					0.5f);
	scene_emit(s, first, (float[]){ 1, 1, 1 });
	lights[0] = scene_point_light(0.3, 0.3, 0.5, 1.0f);
	lights[1] = scene_point_light(0.7, 0.3, 0.5, 1.0f);
	lights[2] = (gw_light){ .type = GW_LIGHT_ENVIRONMENT,
							.radiance = { 1.0f, 1.0f, 1.0f },
							.map = map,
							.map_width = 4,
							.map_height = 2 };
}

/* Of each effect: the passes that it alone has, and its stage. They are there where it is called
 * for, and where it is forbidden none of them runs, has a shader made, or a byte more. */
static void off_is_nothing_done(void **state)
{
	(void)state;
	static const struct {
		gw_effect_kind effect;
		const char *pass[2], *stage;
	} rows[] = {
		{ GW_EFFECT_LAMPS, { "light_irradiance", "light_visibility" }, "direct light" },
		{ GW_EFFECT_SHADOWS, { "light_visibility" }, NULL },
		{ GW_EFFECT_EMITTERS, { "record_emitters" }, NULL },
		{ GW_EFFECT_SKY, { "record_sky", "record_portals" }, NULL },
		{ GW_EFFECT_PORTALS, { "record_portals", "portal_light" }, NULL },
		{ GW_EFFECT_BOUNCES, { "record_gather" }, NULL },
		{ GW_EFFECT_GAPS, { NULL }, "gaps" },
		{ GW_EFFECT_ERROR, { NULL }, "estimate" },
	};
	static const float map[24] = { 1, 1, 1, 2, 2, 2, 1, 1, 1, 3, 3, 3,
								   1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 };
	scene s = { 0 };
	gw_light lights[3];
	make_cellar(&s, lights, map);
	gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	gw_bake_result *all = scene_bake(&points, lights, 3, &options);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		options.effects_forbidden = 1u << rows[i].effect;
		gw_bake_result *without = scene_bake(&points, lights, 3, &options);
		const char *name = gw_effect_name(rows[i].effect);
		assert_true(scene_effect(&all->report, name)->called_for);
		assert_false(scene_effect(&without->report, name)->called_for);
		for (int k = 0; k < 2 && rows[i].pass[k]; k++) {
			assert_non_null(pass_of(&all->report, rows[i].pass[k]));
			assert_null(pass_of(&without->report, rows[i].pass[k]));
		}
		assert_true(!rows[i].stage || scene_has_stage(&all->report, rows[i].stage));
		assert_true(!rows[i].stage || !scene_has_stage(&without->report, rows[i].stage));
		assert_true(without->report.peak_bytes <= all->report.peak_bytes);
		gw_bake_result_destroy(&without);
	}
	assert_null(pass_of(&all->report, "brick_inject"));
	assert_int_equal(all->report.brick_bytes, 0);
	assert_null(all->lamp);
	gw_bake_result_destroy(&all);
	scene_clear(&s);
}

/* On a device that runs all by shaders, only those are compiled that run. */
static void shaders_are_made_when_run(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(0.5, 0.5, 0.75, 2.0f);
	gw_bake_options options = coarse();
	options.passes = GW_PASSES_DEVICE;
	options.effects_forbidden = 1u << GW_EFFECT_SHADOWS | 1u << GW_EFFECT_BOUNCES;
	gw_bake_result *r = scene_bake(&points, &light, 1, &options);
	assert_int_equal(r->report.pass_count, 1);
	assert_string_equal(r->report.pass[0].name, "light_irradiance");
	assert_int_equal(r->report.pass[0].runs, 1);
	assert_int_equal(r->report.pass[0].compiled, 1);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* ------------------------------------------------------------------------------ spots */

/* A spot that shines past every point is left out, whatever shadows and bounces there are. */
static void spots_that_miss(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	gw_points points = scene_points(&s);
	gw_bake_options options = coarse();
	const gw_light away[] = { spot(0.5, 0.5, 2.0, 1.0), spot(0.5, 0.5, 1.5, -1.0) };
	gw_bake_result *r = scene_bake(&points, away, 1, &options);
	assert_false(scene_effect(&r->report, "lamps")->called_for);
	assert_non_null(strstr(scene_effect(&r->report, "lamps")->reason, "shines past all points"));
	assert_int_equal(dispatches_of(&r->report, "direct light"), 0);
	gw_bake_result_destroy(&r);

	gw_bake_result *both = scene_bake(&points, away, 2, &options);
	gw_bake_result *one = scene_bake(&points, away + 1, 1, &options);
	assert_true(scene_effect(&both->report, "lamps")->called_for);
	assert_same_light(both, one);
	assert_int_equal(dispatches_of(&both->report, "direct light"),
					 dispatches_of(&one->report, "direct light"));
	gw_bake_result_destroy(&both);
	gw_bake_result_destroy(&one);
	scene_clear(&s);
}

/* --------------------------------------------------------------- forced, and forbidden */

/* All that is forced where the scene does not call for it adds nothing: the same bytes. Normals
 * that are estimated are others. */
static void forced_changes_nothing(void **state)
{
	(void)state;
	const gw_light lights[] = { spot(0.5, 0.5, 1.5, -1.0), spot(0.5, 0.5, 2.0, 1.0) };
	for (int black = 0; black < 2; black++) {
		scene s = { 0 };
		make_yard(&s, black ? 0.0f : 0.5f);
		gw_points points = scene_points(&s);
		gw_bake_options options = coarse();
		gw_bake_result *plain = scene_bake(&points, lights, 2, &options);
		for (int effect = 0; effect < GW_EFFECT_KIND_COUNT; effect++) {
			if (effect == GW_EFFECT_NORMALS)
				continue;
			options.effects_forced = 1u << effect;
			gw_bake_result *forced = scene_bake(&points, lights, 2, &options);
			assert_true(
				scene_effect(&forced->report, gw_effect_name((gw_effect_kind)effect))->called_for ||
				effect == GW_EFFECT_PORTALS);
			assert_same_light(forced, plain);
			gw_bake_result_destroy(&forced);
		}
		gw_bake_result_destroy(&plain);
		scene_clear(&s);
	}
}

/* Root mean square of the difference of radiance, relative to its mean. */
static double relative_difference(const gw_bake_result *a, const gw_bake_result *b)
{
	double square = 0.0, sum = 0.0;
	for (size_t i = 0; i < 3 * a->count; i++) {
		double off = (double)a->radiance[i] - (double)b->radiance[i];
		square += off * off;
		sum += (double)b->radiance[i];
	}
	return sqrt(square * 3.0 * (double)a->count) / sum;
}

/* Rays slip through rough surface here and there and meet it from behind. That is the same whether
 * or not it is asked of each facet how much it lets through; and maps show it either way. Cones
 * that have gone through one wall take the next one for another: less than the plan says. */
static void forced_transmission(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_make_small_hall(&s);
	for (size_t i = 0; i < 3 * s.count; i++) /* up to 0.7 spacings */
		s.position[i] += 0.12 * (scene_random(&s) - 0.5);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(2.0, 1.5, 2.0, 5.0f);
	for (int way = 0; way < 3; way++) {
		gw_bake_options options = coarse();
		options.shadows = way == 1 ? GW_SHADOWS_MAPS : GW_SHADOWS_TRACED;
		options.method = way == 2 ? GW_METHOD_CONES : GW_METHOD_RAYS;
		gw_bake_result *plain = scene_bake(&points, &light, 1, &options);
		options.effects_forced = 1u << GW_EFFECT_TRANSMISSION;
		gw_bake_result *forced = scene_bake(&points, &light, 1, &options);
		const gw_effect *told = scene_effect(&forced->report, "transmission");
		assert_true(told->called_for);
		assert_true((strstr(told->reason, "may differ by 0.5 %") != NULL) == (way == 2));
		if (way < 2)
			assert_same_light(forced, plain);
		else
			assert_true(relative_difference(forced, plain) < 0.005);
		gw_bake_result_destroy(&forced);
		gw_bake_result_destroy(&plain);
	}
	scene_clear(&s);
}

/* What is forced is computed: black walls are gathered from, and an octree stands in the dark. */
static void forced_is_computed(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.0f);
	gw_points points = scene_points(&s);
	gw_light light = spot(0.5, 0.5, 1.5, -1.0);
	gw_bake_options options = coarse();
	options.effects_forced = 1u << GW_EFFECT_BOUNCES;
	gw_bake_result *r = scene_bake(&points, &light, 1, &options);
	assert_true(scene_has_stage(&r->report, "bounces"));
	assert_true(r->report.records > 0);
	gw_bake_result_destroy(&r);
	options.effects_forced = 1u << GW_EFFECT_OCTREE;
	r = scene_bake(&points, NULL, 0, &options);
	assert_true(r->report.leaves > 0);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* One scene calls for all of them. What is forbidden is missing from the light: of an effect that
 * is there alone, all of it. */
static void forbidden_is_missing(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	scene_emit(&s, 2 * 256, (float[]){ 1, 1, 1 });
	gw_points points = scene_points(&s);
	gw_light lights[] = { spot(0.5, 0.5, 1.5, -1.0), { .type = GW_LIGHT_ENVIRONMENT } };
	for (int c = 0; c < 3; c++)
		lights[1].radiance[c] = 1.0f;
	const gw_effect_kind source[] = { GW_EFFECT_LAMPS, GW_EFFECT_EMITTERS, GW_EFFECT_SKY };
	static const char *const stage[] = { "direct light", "first gather", "first gather" };
	uint32_t sources = 0;
	for (int i = 0; i < 3; i++)
		sources |= 1u << source[i];
	gw_bake_options options = coarse();
	for (int i = 0; i < 3; i++) {
		/* This one alone, then all but this one. */
		options.effects_forbidden = sources & ~(1u << source[i]);
		gw_bake_result *alone = scene_bake(&points, lights, 2, &options);
		options.effects_forbidden = sources;
		gw_bake_result *dark = scene_bake(&points, lights, 2, &options);
		assert_true(scene_has_stage(&alone->report, stage[i]));
		assert_true(scene_mean(alone->direct_irradiance, s.count, 0) > 0.0);
		assert_true(scene_mean(alone->indirect_irradiance, s.count, 0) > 0.0);
		assert_int_equal(dispatches_of(&dark->report, stage[i]), 0);
		for (size_t k = 0; k < 3 * s.count; k++)
			assert_true(dark->direct_irradiance[k] == 0.0f && dark->indirect_irradiance[k] == 0.0f);
		gw_bake_result_destroy(&alone);
		gw_bake_result_destroy(&dark);
	}
	scene_clear(&s);
}

/* What is forbidden of the surface is not made, where the points call for it: half of them are
 * clear, all scatter, and none has a normal of its own. */
static void forbidden_of_surface(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	float *opacity = malloc(s.count * sizeof *opacity);
	for (size_t i = 0; i < s.count; i++) {
		opacity[i] = i % 2 ? 1.0f : 0.5f;
		for (size_t k = 0; k < 3; k++) /* a third of the spacing of 1/16, evenly distributed */
			s.position[3 * i + k] += (double)((i * 2654435761u >> (8 * k)) & 255) / 255 / 48;
	}
	gw_points points = scene_points(&s);
	points.opacity = opacity;
	gw_light light = spot(0.5, 0.5, 1.5, -1.0);
	const gw_effect_kind effect[] = { GW_EFFECT_TRANSMISSION, GW_EFFECT_NOISE };
	for (size_t i = 0; i < 2; i++) {
		gw_bake_options options = coarse();
		const char *name = gw_effect_name(effect[i]);
		gw_bake_result *wanted = scene_bake(&points, &light, 1, &options);
		options.effects_forbidden = 1u << effect[i];
		gw_bake_result *without = scene_bake(&points, &light, 1, &options);
		assert_true(scene_effect(&wanted->report, name)->called_for);
		assert_false(scene_effect(&without->report, name)->called_for);
		assert_memory_not_equal(wanted->radiance, without->radiance,
								3 * s.count * sizeof *wanted->radiance);
		if (effect[i] == GW_EFFECT_TRANSMISSION) {
			gw_points opaque = points;
			opaque.opacity = NULL;
			options.effects_forbidden = 0;
			gw_bake_result *same = scene_bake(&opaque, &light, 1, &options);
			assert_same_light(without, same);
			gw_bake_result_destroy(&same);
		}
		gw_bake_result_destroy(&wanted);
		gw_bake_result_destroy(&without);
	}
	free(opacity);
	scene_clear(&s);
}

/* Forced, normals are those that are estimated; forbidden, those that were given, as by the option
 * of their own. */
static void chosen_normals(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	gw_points points = scene_points(&s);
	gw_light light = spot(0.5, 0.5, 1.5, -1.0);
	for (int forced = 0; forced < 2; forced++) {
		gw_bake_options by_effect = coarse(), by_option = coarse();
		by_effect.effects_forced = forced ? 1u << GW_EFFECT_NORMALS : 0;
		by_effect.effects_forbidden = forced ? 0 : 1u << GW_EFFECT_NORMALS;
		by_option.normals = forced ? GW_NORMALS_ESTIMATE : GW_NORMALS_GIVEN;
		gw_bake_result *a = scene_bake(&points, &light, 1, &by_effect);
		gw_bake_result *b = scene_bake(&points, &light, 1, &by_option);
		assert_same_light(a, b);
		assert_true(scene_effect(&a->report, "normals")->called_for == (forced != 0));
		gw_bake_result_destroy(&a);
		gw_bake_result_destroy(&b);
	}
	scene_clear(&s);
}

/* The mean irradiance of `count` points of a scene, from number `first` on, by options. */
static double mean_of(const scene *s, const gw_light *light, const gw_bake_options *options,
					  size_t first, size_t count)
{
	gw_points points = scene_points(s);
	gw_bake_result *r = scene_bake(&points, light, light ? 1 : 0, options);
	double sum = scene_mean(r->direct_irradiance + 3 * first, count, 0) +
				 scene_mean(r->indirect_irradiance + 3 * first, count, 0);
	gw_bake_result_destroy(&r);
	return sum;
}

/* By how much the light differs without an effect: a sun of 1 W/m^2 straight from above gives the
 * floor below a plate nothing, and 1 without shadows. A plane whose given normals lean by 60
 * degrees gets 1/2 with them, and 1 with its own: points at a height of 0 lie on a plane exactly.
 * In a glowing sphere of albedo 1/2 there is twice what it sends out; by one reflection alone,
 * once. */
static void forbidden_by_known_amounts(void **state)
{
	(void)state;
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .direction = { 0, 0, -1 },
						   .irradiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_options plain = coarse(), shadows = coarse(), normals = coarse(), bounces = coarse();
	plain.normals = GW_NORMALS_ESTIMATE;
	shadows.effects_forbidden = 1u << GW_EFFECT_SHADOWS;
	normals.effects_forbidden = 1u << GW_EFFECT_NORMALS;
	bounces.effects_forbidden = 1u << GW_EFFECT_BOUNCES;
	scene s = { 0 };
	const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 };
	scene_add_patch(&s, &(scene_patch){ (double[3]){ 0, 0, 0 }, x, y, 24, 24 }, 0.0f);
	scene_add_patch(&s,
					&(scene_patch){ (double[3]){ -0.5, -0.5, 0.5 }, (double[3]){ 2, 0, 0 },
									(double[3]){ 0, 2, 0 }, 48, 48 },
					0.0f);
	const gw_bake_options ordinary = coarse();
	assert_true(mean_of(&s, &sun, &ordinary, 0, 576) == 0.0);
	assert_true(mean_of(&s, &sun, &shadows, 0, 576) == 1.0);
	scene_clear(&s);

	scene_add_patch(&s, &(scene_patch){ (double[3]){ 0, 0, 0 }, x, y, 24, 24 }, 0.0f);
	for (size_t i = 0; i < s.count; i++) {
		s.normal[3 * i] = 0.8660254f;
		s.normal[3 * i + 2] = 0.5f;
	}
	assert_true(mean_of(&s, &sun, &plain, 0, 576) == 1.0);
	/* The given normals are of length 1 to 2^-24. */
	assert_true(fabs(mean_of(&s, &sun, &normals, 0, 576) - 0.5) <= ldexp(1.0, -24));
	scene_clear(&s);

	/* Discs of a sphere lie within 1 % of its radius. */
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, 2000, -1, 0.5f);
	scene_emit(&s, 0, (float[]){ 1, 1, 1 });
	assert_true(fabs(mean_of(&s, NULL, &ordinary, 0, s.count) / SCENE_PI - 2.0) < 0.02);
	assert_true(fabs(mean_of(&s, NULL, &bounces, 0, s.count) / SCENE_PI - 1.0) < 0.01);
	scene_clear(&s);
}

/* What contradicts other options is refused with a sentence that names the effect. */
static void contradictions(void **state)
{
	(void)state;
	scene s = { 0 };
	make_yard(&s, 0.5f);
	gw_points points = scene_points(&s);
	const gw_scene_description described = { &points, NULL, 0 };
	gw_bake_options shadows = coarse(), bounces = coarse(), octree = coarse(), gaps = coarse();
	shadows.shadows = GW_SHADOWS_NONE;
	shadows.effects_forced = 1u << GW_EFFECT_SHADOWS;
	bounces.bounces = 1;
	bounces.effects_forced = 1u << GW_EFFECT_BOUNCES;
	octree.effects_forbidden = 1u << GW_EFFECT_OCTREE;
	gaps.unknown = true;
	gaps.effects_forbidden = 1u << GW_EFFECT_GAPS;
	const struct {
		const gw_bake_options *options;
		const char *name;
	} rows[] = { { &shadows, "'shadows'" },
				 { &bounces, "'bounces'" },
				 { &octree, "'octree'" },
				 { &gaps, "'gaps'" } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		gw_bake_result *result;
		gw_error error = { 0 };
		assert_int_equal(gw_bake(&described, rows[i].options, NULL, &result, &error),
						 GW_ERROR_USAGE);
		assert_non_null(strstr(error.text, rows[i].name));
	}
	scene_clear(&s);
}

/* ------------------------------------------------------------------------- the plan itself */

/* A scene in another order: every 7th of its points after each other, which their number is no
 * multiple of. */
static void shuffle(const scene *from, const float *opacity, scene *to, float *to_opacity)
{
	for (size_t i = 0, k = 0; i < from->count; i++, k = (k + 7) % from->count) {
		scene_add(to, from->position + 3 * k,
				  (double[]){ (double)from->normal[3 * k], (double)from->normal[3 * k + 1],
							  (double)from->normal[3 * k + 2] },
				  from->albedo[3 * k]);
		if (from->emission[3 * k] > 0.0f)
			scene_emit(to, i, from->emission + 3 * k);
		to_opacity[i] = opacity[k];
	}
}

static void assert_same_plan(const gw_bake_result *a, const gw_bake_result *b)
{
	assert_int_equal(a->report.effect_count, b->report.effect_count);
	for (uint32_t i = 0; i < a->report.effect_count; i++) {
		const gw_effect *left = &a->report.effect[i], *right = &b->report.effect[i];
		assert_string_equal(left->name, right->name);
		assert_string_equal(left->reason, right->reason);
		assert_string_equal(left->method, right->method);
		assert_int_equal(left->called_for, right->called_for);
	}
	assert_int_equal(a->given_count, b->given_count);
	for (size_t i = 0; i < a->given_count; i++) {
		assert_int_equal(a->given[i].fate, b->given[i].fate);
		assert_true(a->given[i].share == b->given[i].share ||
					(isnan(a->given[i].share) && isnan(b->given[i].share)));
	}
	assert_true(a->report.forecast.error == b->report.forecast.error);
	assert_int_equal(a->report.forecast.device_bytes, b->report.forecast.device_bytes);
	assert_int_equal(a->report.forecast.records, b->report.forecast.records);
}

/* What is decided, why, and what is foretold but for seconds does not depend on the order of the
 * points: of a hall in which a patch glows, a part is clear, lamps shine and miss, under a sky. */
static void order_of_points(void **state)
{
	(void)state;
	scene s = { 0 }, other = { 0 };
	scene_make_small_hall(&s);
	float *opacity = malloc(2 * s.count * sizeof *opacity), *shuffled = opacity + s.count;
	for (size_t i = 0; i < s.count; i++)
		opacity[i] = i % 5 ? 1.0f : 0.5f;
	assert_true(s.count % 7 != 0);
	for (size_t i = 0; i < s.count; i++) /* grey: scene_add takes one number */
		s.albedo[3 * i] = s.albedo[3 * i + 1] = s.albedo[3 * i + 2];
	shuffle(&s, opacity, &other, shuffled);
	gw_light lights[3] = { spot(0.5, 0.5, 1.5, -1.0),
						   spot(0.5, 0.5, 3.0, 1.0),
						   { .type = GW_LIGHT_ENVIRONMENT } };
	for (int c = 0; c < 3; c++)
		lights[2].radiance[c] = 1.0f;
	const gw_bake_options options = coarse();
	gw_bake_result *plan[2];
	for (int i = 0; i < 2; i++) {
		gw_points points = scene_points(i ? &other : &s);
		points.opacity = i ? shuffled : opacity;
		gw_error error = { 0 };
		assert_int_equal(gw_plan_bake(&(gw_scene_description){ &points, lights, 3 }, &options, NULL,
									  &plan[i], &error),
						 GW_OK);
	}
	assert_true(scene_effect(&plan[0]->report, "transmission")->called_for);
	assert_true(scene_effect(&plan[0]->report, "emitters")->called_for);
	assert_true(scene_effect(&plan[0]->report, "sky")->called_for);
	assert_same_plan(plan[0], plan[1]);
	for (int i = 0; i < 2; i++)
		gw_bake_result_destroy(&plan[i]);
	free(opacity);
	scene_clear(&other);
	scene_clear(&s);
}

typedef struct planned {
	int calls;
	gw_forecast forecast;
	uint32_t effects;
} planned;

static void on_planned(void *user, const gw_bake_result *plan)
{
	planned *p = user;
	p->calls++;
	p->forecast = plan->report.forecast;
	p->effects = plan->report.effect_count;
}

/* What is computed has a price, and what is not has none; no effect takes longer than all. */
static void assert_prices(const gw_report *report, double whole)
{
	for (uint32_t i = 0; i < report->effect_count; i++) {
		const gw_effect *e = &report->effect[i];
		assert_true(e->seconds >= 0.0 && e->seconds <= whole);
		assert_true(e->called_for || e->seconds == 0.0);
	}
	assert_true(scene_effect(report, "bounces")->seconds > 0.0);
	assert_true(scene_effect(report, "octree")->seconds > 0.0);
	assert_true(scene_effect(report, "lamps")->seconds > 0.0);
}

static void assert_memory_foretold(uint64_t foretold, const gw_bake_result *came, double allowed)
{
	double off = (double)foretold - (double)came->report.peak_bytes;
	if (!(fabs(off) <= allowed))
		fail_msg("%.0f bytes were foretold, %.0f too many, where %.0f are allowed",
				 (double)foretold, off, allowed);
}

/* A bake that tells what it will take gives the same light, and a plan without the bake tells the
 * same but for seconds. The estimate of the error holds what came within what it says. */
static void check_foretold(const scene *s, gw_bake_options options)
{
	gw_points points = scene_points(s);
	gw_light light = scene_point_light(2.0, 1.5, 2.0, 5.0f);
	const gw_scene_description described = { &points, &light, 1 };
	scene_choose_passes(&options.passes, &options.validate);
	gw_bake_result *plain = scene_bake(&points, &light, 1, &options), *told = NULL;
	planned p = { 0 };
	gw_error error = { 0 };
	const gw_bake_callbacks callbacks = { .user = &p, .planned = on_planned };
	assert_int_equal(gw_bake(&described, &options, &callbacks, &told, &error), GW_OK);
	assert_same_light(told, plain);
	assert_int_equal(plain->report.forecast.places, 0);
	assert_int_equal(p.calls, 1);
	assert_int_equal(p.effects, told->report.effect_count);
	assert_int_equal(p.forecast.records, told->report.records);
	assert_true(p.forecast.places > 0 && p.forecast.places <= p.forecast.records);
	assert_true(p.forecast.seconds > p.forecast.done_seconds && p.forecast.own_seconds > 0.0);
	assert_true(fabs(p.forecast.error - told->report.error.relative_rms) <
				p.forecast.spread + told->report.error.spread);
	/* Memory is counted, but for the points that are solved again, of which the forecast has fewer.
	 * Each takes as much as a record: a facet and a distance a ray, six vectors. */
	assert_memory_foretold(p.forecast.device_bytes, told,
						   told->report.error.points * (8.0 * options.rays + 6.0 * 16.0));
	gw_bake_result *plan = NULL;
	assert_int_equal(gw_plan_bake(&described, &options, NULL, &plan, &error), GW_OK);
	const gw_report *report = &plan->report;
	assert_int_equal(report->forecast.places, p.forecast.places);
	assert_int_equal(report->forecast.device_bytes, p.forecast.device_bytes);
	assert_true(report->forecast.error == p.forecast.error);
	assert_int_equal(report->forecast.bounces, p.forecast.bounces);
	assert_false(scene_has_stage(report, "records"));
	assert_int_equal(plan->count, 0);
	assert_int_equal(plan->given_count, 1);
	assert_int_equal(plan->given[0].fate, GW_LIGHT_SHINES);
	/* What emits is gathered at few places, as all light that the error is foretold of. */
	assert_true(fabs(plan->given[0].share - told->given[0].share) < report->forecast.error);
	assert_prices(report, report->forecast.seconds);
	assert_prices(&told->report, 1e9);
	gw_bake_result_destroy(&plan);
	gw_bake_result_destroy(&told);
	gw_bake_result_destroy(&plain);
}

static void foretold(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_make_hall(&s);
	check_foretold(&s, gw_bake_options_default());
	scene_clear(&s);
}

/* The same of ways to gather whose time does not go with the number of records. */
static void other_methods_foretold(void **state)
{
	const gw_method methods[] = { GW_METHOD_VOLUME, GW_METHOD_LPV, GW_METHOD_PROBES };
	(void)state;
	scene s = { 0 };
	scene_make_hall(&s);
	for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
		gw_bake_options options = gw_bake_options_default();
		options.method = methods[m];
		options.volume_cells = 16;
		options.probe_size = 32;
		check_foretold(&s, options);
	}
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_octree_without_need),
		cmocka_unit_test(nothing_without_light),
		cmocka_unit_test(scenes_for_bare_lamps),
		cmocka_unit_test(off_is_nothing_done),
		cmocka_unit_test(shaders_are_made_when_run),
		cmocka_unit_test(spots_that_miss),
		cmocka_unit_test(forced_changes_nothing),
		cmocka_unit_test(forced_transmission),
		cmocka_unit_test(forced_is_computed),
		cmocka_unit_test(forbidden_is_missing),
		cmocka_unit_test(forbidden_of_surface),
		cmocka_unit_test(chosen_normals),
		cmocka_unit_test(forbidden_by_known_amounts),
		cmocka_unit_test(contradictions),
		cmocka_unit_test(order_of_points),
		cmocka_unit_test(foretold),
		cmocka_unit_test(other_methods_foretold),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
