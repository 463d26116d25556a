/*
 * test_opacity.c - surface that lets a share of the light through, against closed forms.
 *
 * Of a surface of opacity a the share a is covered, at any angle; so a sheet lets 1 - a through,
 * sheets one behind the other the product, and a slab, which has two faces, (1 - a)^2.
 */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define FLOOR 40 /* points a side of the floor, 4 m wide */
#define SHEET 36 /* of a sheet, SHEET_WIDTH wide */
#define SHEET_WIDTH 3.2

/* A scene whose points have an opacity. */
typedef struct clear_scene {
	scene scene;
	float *opacity;
} clear_scene;

static void give(clear_scene *s, size_t first, float opacity)
{
	s->opacity = realloc(s->opacity, s->scene.count * sizeof *s->opacity);
	assert_non_null(s->opacity);
	for (size_t i = first; i < s->scene.count; i++)
		s->opacity[i] = opacity;
}

static void add_patch(clear_scene *s, const scene_patch *patch, float albedo, float opacity)
{
	size_t first = s->scene.count;
	scene_add_patch(&s->scene, patch, albedo);
	give(s, first, opacity);
}

static void add_floor(clear_scene *s)
{
	add_patch(s,
			  &(scene_patch){ (double[]){ -2, -2, 0 }, (double[]){ 4, 0, 0 }, (double[]){ 0, 4, 0 },
							  FLOOR, FLOOR },
			  0.5f, 1.0f);
}

/* A sheet at a height that faces up or down; noise along its normal, metres. */
static void add_sheet(clear_scene *s, double height, int facing, double noise, float opacity)
{
	double half = 0.5 * SHEET_WIDTH;
	size_t first = s->scene.count;
	const double x[3] = { SHEET_WIDTH, 0, 0 }, y[3] = { 0, SHEET_WIDTH, 0 };
	add_patch(s,
			  &(scene_patch){ (double[]){ -half, -half, height }, facing > 0 ? x : y,
							  facing > 0 ? y : x, SHEET, SHEET },
			  0.5f, opacity);
	for (size_t i = first; i < s->scene.count && noise > 0.0; i++)
		s->scene.position[3 * i + 2] +=
			noise * (scene_random(&s->scene) + scene_random(&s->scene) - 1.0) * sqrt(6.0);
}

static void clear(clear_scene *s)
{
	scene_clear(&s->scene);
	free(s->opacity);
	*s = (clear_scene){ .opacity = NULL };
}

static gw_points points_of(const clear_scene *s)
{
	gw_points points = scene_points(&s->scene);
	points.opacity = s->opacity;
	return points;
}

static gw_bake_options plain_options(void)
{
	gw_bake_options options = gw_bake_options_default();
	options.bounces = 1;
	options.estimate_points = 0;
	return options;
}

static gw_light sun_at(double degrees)
{
	double turn = degrees * SCENE_PI / 180.0;
	return (gw_light){ .type = GW_LIGHT_SUN,
					   .direction = { sin(turn), 0, -cos(turn) },
					   .irradiance = { 1.0f, 1.0f, 1.0f } };
}

/* What of a sun's light gets to the floor below the inner part of sheets of a height. */
typedef struct passage {
	double mean;
	double off; /* share of points more than 1e-4 off what is expected */
} passage;

static passage look_below(const clear_scene *s, double lowest, double highest, double degrees,
						  uint32_t depth, double expected)
{
	gw_points points = points_of(s);
	gw_bake_options options = plain_options();
	gw_light sun = sun_at(degrees);
	options.depth = depth;
	gw_bake_result *result = scene_bake(&points, &sun, 1, &options);
	double slope = tan(degrees * SCENE_PI / 180.0), inner = 0.5 * SHEET_WIDTH - 0.2;
	double sum = 0.0, off = 0.0, count = 0.0;
	for (size_t i = 0; i < (size_t)FLOOR * FLOOR; i++) {
		const double *p = points.position + 3 * i;
		if (fabs(p[1]) > inner || fabs(p[0] - lowest * slope) > inner ||
			fabs(p[0] - highest * slope) > inner)
			continue;
		double share = (double)result->direct_irradiance[3 * i] / cos(degrees * SCENE_PI / 180.0);
		sum += share;
		off += fabs(share - expected) > 1e-4;
		count += 1.0;
	}
	gw_bake_result_destroy(&result);
	assert_true(count > 100.0);
	return (passage){ sum / count, off / count };
}

static const double angles[] = { 0.0, 45.0, 70.0 };

/* A plane has one height, so that nothing but roundings of the irradiance, relative to 1, is left.
 * For the README: with GLOWWORM_TEST_TABLE set, prints what gets through. */
static void test_slab(void **state)
{
	(void)state;
	bool table = getenv("GLOWWORM_TEST_TABLE") != NULL;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	add_sheet(&s, 0.3, -1, 0.0, 0.3f);
	add_sheet(&s, 0.6, 1, 0.0, 0.3f);
	for (uint32_t depth = 6; depth <= 10; depth += table ? 1 : 2)
		for (size_t a = 0; a < 3; a++) {
			passage p = look_below(&s, 0.3, 0.6, angles[a], depth, 0.49);
			if (table)
				print_message("| %u | %.0f | %.4f |\n", depth, angles[a], p.mean);
			assert_true(fabs(p.mean - 0.49) < 1e-4 && p.off == 0.0);
		}
	clear(&s);
}

/* Four sheets that face alike, of two opacities. Where points happen to lie far apart, a ray in a
 * thousand takes two of them for one. */
static void test_stack(void **state)
{
	(void)state;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	for (int i = 0; i < 4; i++)
		add_sheet(&s, 0.2 + 0.25 * i, 1, 0.0, i % 2 ? 0.2f : 0.6f);
	for (uint32_t depth = 6; depth <= 10; depth += 4)
		for (size_t a = 0; a < 3; a++) {
			passage p = look_below(&s, 0.2, 0.95, angles[a], depth, 0.1024);
			assert_true(fabs(p.mean - 0.1024) < 2e-4 && p.off < 0.005);
		}
	clear(&s);
}

/* Noise of 0.3 spacings along the normal, so that planes and discs of a sheet lie in front of each
 * other: it still counts once. Single rays miss it, or meet a disc that sticks out twice: one in a
 * hundred, as rays do that a rough surface of no transparency is to stop. */
static void test_rough(void **state)
{
	(void)state;
	for (uint32_t depth = 6; depth <= 9; depth++) {
		for (int facing = -1; facing <= 1; facing += 2) {
			clear_scene s = { .opacity = NULL };
			add_floor(&s);
			add_sheet(&s, 0.5, facing, 0.3 * SHEET_WIDTH / SHEET, 0.4f);
			passage p = look_below(&s, 0.5, 0.5, 60.0, depth, 0.6);
			assert_true(p.off < 0.01);
			clear(&s);
		}
	}
}

/* The mean irradiance of the first 32 x 32 points, a floor, under an even sky; uses up the scene.
 */
static double floor_under_sky(clear_scene *s, gw_method method, bool *portal)
{
	gw_points points = points_of(s);
	gw_bake_options options = plain_options();
	options.method = method;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_result *result = scene_bake(&points, &sky, 1, &options);
	double mean = scene_mean(result->direct_irradiance, 32 * 32, 0);
	*portal = scene_effect(&result->report, "portals")->called_for;
	gw_bake_result_destroy(&result);
	clear(s);
	return mean;
}

/* A black box of 1 m whose lid has an opacity, or is missing, and what of a sky gets to its floor:
 * pi times the form factor of two opposite sides of a cube, 0.19982. */
static double sky_in_box(float opacity)
{
	clear_scene s = { .opacity = NULL };
	const struct {
		double corner[3], u[3], v[3];
	} patch[] = {
		{ { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } }, { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
		{ { 1, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 } }, { { 0, 0, 0 }, { 0, 0, 1 }, { 1, 0, 0 } },
		{ { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } }, { { 0, 0, 1 }, { 0, 1, 0 }, { 1, 0, 0 } },
	};
	for (size_t i = 0; i < (opacity > 0.0f ? 6 : 5); i++)
		add_patch(&s, &(scene_patch){ patch[i].corner, patch[i].u, patch[i].v, 32, 32 }, 0.0f,
				  i < 5 ? 1.0f : opacity);
	bool portal;
	return floor_under_sky(&s, GW_METHOD_RAYS, &portal);
}

/* Rays that leave: some 1000 records of 64 rays of which a tenth do, so 0.4 % of noise each, and 2
 * % for the facets at the lid's edge and the points' own heights. A closed lid keeps all out. */
static void test_roof(void **state)
{
	(void)state;
	double open = sky_in_box(0.0f), half = sky_in_box(0.5f);
	assert_true(fabs(half / (0.5 * 0.19982 * SCENE_PI) - 1.0) < 0.04);
	assert_true(fabs(half / open - 0.5) < 0.02);
	assert_true(sky_in_box(1.0f) == 0.0);
}

/* The mean irradiance of the middle of the points from number `first` on, of a floor or a sheet,
 * under an even sky of radiance 1 that cones gather. */
static double middle_by_cones(const clear_scene *s, size_t first, size_t count)
{
	gw_points points = points_of(s);
	gw_bake_options options = plain_options();
	options.method = GW_METHOD_CONES;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_result *result = scene_bake(&points, &sky, 1, &options);
	double sum = 0.0, inside = 0.0;
	for (size_t i = first; i < first + count; i++) {
		if (fabs(points.position[3 * i]) > 0.5 || fabs(points.position[3 * i + 1]) > 0.5)
			continue;
		sum += (double)result->direct_irradiance[3 * i];
		inside += 1.0;
	}
	gw_bake_result_destroy(&result);
	return sum / inside;
}

/* The mean irradiance of the middle of a floor under a map of the sky that is dark but for 17
 * degrees around the zenith, below a sheet of an opacity, or none for 0. */
static double below_map(float opacity, gw_method method)
{
	static float pixels[3 * 64 * 32];
	for (size_t i = 0; i < (size_t)3 * 64 * 3; i++)
		pixels[i] = 1.0f;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	if (opacity > 0.0f)
		add_sheet(&s, 0.4, -1, 0.0, opacity);
	gw_points points = points_of(&s);
	gw_bake_options options = plain_options();
	options.method = method;
	const gw_light map = { .type = GW_LIGHT_ENVIRONMENT,
						   .radiance = { 1.0f, 1.0f, 1.0f },
						   .map = pixels,
						   .map_width = 64,
						   .map_height = 32 };
	gw_bake_result *result = scene_bake(&points, &map, 1, &options);
	double sum = 0.0, inside = 0.0;
	for (size_t i = 0; i < (size_t)FLOOR * FLOOR; i++) {
		if (fabs(points.position[3 * i]) > 0.5 || fabs(points.position[3 * i + 1]) > 0.5)
			continue;
		sum += (double)result->direct_irradiance[3 * i];
		inside += 1.0;
	}
	gw_bake_result_destroy(&result);
	clear(&s);
	return sum / inside;
}

/* A map's samples get through a sheet as all light does, whatever gathers. Its three rows are 16.9
 * degrees, pi sin^2 of which is 0.265; pi / 32 radians high each, the uppermost is a disc, and what
 * samples are off where it is curved and where cosines differ within a row is below 2 %. */
static void test_map(void **state)
{
	(void)state;
	const gw_method method[] = { GW_METHOD_RAYS, GW_METHOD_CONES };
	for (size_t i = 0; i < 2; i++) {
		double sine = sin(3.0 * SCENE_PI / 32.0), open = below_map(0.0f, method[i]);
		assert_true(fabs(open / (SCENE_PI * sine * sine) - 1.0) < 0.02);
		assert_true(fabs(below_map(0.4f, method[i]) / open - 0.6) < 0.01);
		assert_true(fabs(below_map(1.0f, method[i]) / open) < 1e-3);
	}
}

/* Cones, through a sheet of either facing. Over the floor's middle it covers the sky but for what
 * lies below its edges: at least h^2 / (h^2 + r^2) of it with r the half diagonal and at most with
 * r the half side, of a sheet of height h, as over its middle; half a metre aside the mean lies
 * between them still. The sheet's own light is that of the whole sky, of which its own back takes
 * nothing: but for what a tenth of a voxel's unevenness of a tenth of the cones leaves, 1 %. */
static void test_cones(void **state)
{
	(void)state;
	const double h = 0.4, half = 0.5 * SHEET_WIDTH;
	const double least = h * h / (h * h + 2.0 * half * half), most = h * h / (h * h + half * half);
	for (int facing = -1; facing <= 1; facing += 2)
		for (float opacity = 0.3f; opacity < 1.0f; opacity += 0.3f) {
			clear_scene s = { .opacity = NULL };
			add_floor(&s);
			add_sheet(&s, h, facing, 0.0, opacity);
			double share = middle_by_cones(&s, 0, (size_t)FLOOR * FLOOR) / SCENE_PI;
			double clear_share = 1.0 - (double)opacity;
			/* One of a record's 16 cones lies across the sheet's edges, half of it: 3 %. */
			assert_true(share > clear_share + least * (double)opacity - 0.03);
			assert_true(share < clear_share + most * (double)opacity + 0.03);
			double own = middle_by_cones(&s, (size_t)FLOOR * FLOOR, (size_t)SHEET * SHEET);
			assert_true(facing < 0 || fabs(own / SCENE_PI - 1.0) < 0.01);
			clear(&s);
		}
}

/* Every point of a sheet once more, facing the other way: lit from both sides. */
static void show_both_sides(clear_scene *s, size_t first, float opacity)
{
	size_t end = s->scene.count;
	for (size_t i = first; i < end; i++) {
		double place[3], normal[3];
		for (size_t k = 0; k < 3; k++) {
			place[k] = s->scene.position[3 * i + k];
			normal[k] = -(double)s->scene.normal[3 * i + k];
		}
		scene_add(&s->scene, place, normal, 0.5f);
	}
	give(s, end, opacity);
}

/* By cones under the sky, the means of the middle of the points from the first one to `end`. */
static void light_by_cones(const clear_scene *s, size_t end, double *direct, double *indirect)
{
	gw_points points = points_of(s);
	gw_bake_options options = plain_options();
	options.method = GW_METHOD_CONES;
	options.bounces = 2;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_result *result = scene_bake(&points, &sky, 1, &options);
	double inside = 0.0;
	*direct = *indirect = 0.0;
	for (size_t i = 0; i < end; i++) {
		if (fabs(points.position[3 * i]) > 0.5 || fabs(points.position[3 * i + 1]) > 0.5)
			continue;
		*direct += (double)result->direct_irradiance[3 * i];
		*indirect += (double)result->indirect_irradiance[3 * i];
		inside += 1.0;
	}
	*direct /= inside;
	*indirect /= inside;
	gw_bake_result_destroy(&result);
}

/* A flat sheet does not light itself, whichever sides it shows, nor darken itself: but for the 11
 * bits of the voxels' numbers. One that leans is as thick as its voxels, of which not all that is
 * above it is below it as well: a hundredth of the sky's light. */
static void test_cones_own_light(void **state)
{
	(void)state;
	for (int lean = 0; lean < 2; lean++)
		for (float opacity = 0.3f; opacity < 1.0f; opacity += 0.35f) {
			clear_scene s = { .opacity = NULL };
			double direct, indirect, limit = SCENE_PI * (lean ? 0.01 : ldexp(1.0, -11));
			add_patch(&s,
					  &(scene_patch){ (double[]){ -1.6, -1.6, lean ? -0.64 : 0.01 },
									  (double[]){ 3.2, 0, lean ? 1.28 : 0.0 },
									  (double[]){ 0, 3.2, 0 }, SHEET, SHEET },
					  0.5f, opacity);
			show_both_sides(&s, 0, opacity);
			light_by_cones(&s, s.scene.count, &direct, &indirect);
			if (!(indirect <= limit && fabs(direct - SCENE_PI) <= limit))
				fail_msg("of opacity %g, leaning %d: %g of the sky, %g of itself", (double)opacity,
						 lean, direct, indirect);
			clear(&s);
		}
}

/*
 * A clear sheet two spacings below one that nothing gets through and that reflects 0.9: of the
 * sky's light it gets what gets through itself and comes back. Cones that begin on the upper one
 * have their first samples 1.5 and 2.5 leaf cells below it, and voxels of the lower one, 1.6 cells
 * off, have their centres at 1.1 to 2.1: of what is covered they find six tenths at least. What
 * comes in at the sides, and one in 16 cones, half of it, is as in test_cones.
 */
static void test_cones_beside_white(void **state)
{
	(void)state;
	const double apart = 2.0 * SHEET_WIDTH / SHEET, near = 0.5 * SHEET_WIDTH - 0.5;
	const double side = apart * apart / (apart * apart + near * near) + 0.03;
	for (int both = 0; both < 2; both++)
		for (float opacity = 0.3f; opacity < 1.0f; opacity += 0.35f) {
			clear_scene s = { .opacity = NULL };
			double direct, indirect, a = (double)opacity;
			add_sheet(&s, 0.0, 1, 0.0, opacity);
			if (both)
				show_both_sides(&s, 0, opacity);
			size_t end = s.scene.count;
			add_patch(&s,
					  &(scene_patch){ (double[]){ -1.6, -1.6, apart }, (double[]){ 0, 3.2, 0 },
									  (double[]){ 3.2, 0, 0 }, SHEET, SHEET },
					  0.9f, 1.0f);
			light_by_cones(&s, end, &direct, &indirect);
			if (!(direct < side * SCENE_PI && indirect > (0.9 * (1.0 - a) - 0.03) * SCENE_PI &&
				  indirect < (0.9 * (1.0 - 0.6 * a) + side) * SCENE_PI))
				fail_msg("sides %d, opacity %g: %g of the sky, %g reflected", both + 1, a, direct,
						 indirect);
			clear(&s);
		}
}

/*
 * A sheet of opacity 0.5 over another one of that opacity, or over what is opaque, 2.7 leaf cells
 * above it and alike: half of the sky's light gets to the lower one, and what comes in at the
 * sides, as in test_cones. Both lie flat, or rise by 0.4: then the faces of voxels show more of a
 * sheet than it covers, and what is above the lower one lies less far from it.
 */
static void test_cones_close_sheets(void **state)
{
	(void)state;
	for (int way = 0; way < 4; way++) {
		const double lower = way & 1 ? 1.0 : 0.5, rise = way & 2 ? 0.4 : 0.0;
		const double square = 1.0 + rise * rise, half = 0.5 * SHEET_WIDTH;
		const double height = 0.3 * 0.3 / square, side = half * half;
		const double least = height / (height + side * (1.0 + square));
		const double most = height / (height + side);
		clear_scene s = { .opacity = NULL };
		double direct, indirect;
		for (int i = 0; i < 2; i++)
			add_patch(&s,
					  &(scene_patch){ (double[]){ -half, -half, 0.3 * i - half * rise },
									  (double[]){ SHEET_WIDTH, 0, rise * SHEET_WIDTH },
									  (double[]){ 0, SHEET_WIDTH, 0 }, SHEET, SHEET },
					  0.0f, i ? 0.5f : (float)lower);
		light_by_cones(&s, (size_t)SHEET * SHEET, &direct, &indirect);
		if (!(direct > (0.5 + 0.5 * least - 0.03) * SCENE_PI &&
			  direct < (0.5 + 0.5 * most + 0.03) * SCENE_PI))
			fail_msg("%g of the sky on opacity %g, rising by %g", direct / SCENE_PI, lower, rise);
		clear(&s);
	}
}

/* Two sheets of opacity 0.5 that rise along x, one above the other by `apart`, under a sky. */
static gw_bake_result *bake_pair(double apart, double rise, gw_method method)
{
	const double half = 0.5 * SHEET_WIDTH;
	clear_scene s = { .opacity = NULL };
	for (int i = 0; i < 2; i++)
		add_patch(&s,
				  &(scene_patch){ (double[]){ -half, -half, apart * i - half * rise },
								  (double[]){ SHEET_WIDTH, 0, rise * SHEET_WIDTH },
								  (double[]){ 0, SHEET_WIDTH, 0 }, SHEET, SHEET },
				  0.5f, 0.5f);
	gw_points points = points_of(&s);
	gw_bake_options options = gw_bake_options_default();
	options.bounces = 1;
	options.method = method;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_result *result = scene_bake(&points, &sky, 1, &options);
	clear(&s);
	return result;
}

/* The mean over what is at least an eighth of a sheet's width from its edges. */
static double middle_of(const gw_bake_result *result, size_t first)
{
	double sum = 0.0, count = 0.0;
	for (size_t i = 0; i < (size_t)SHEET * SHEET; i++) {
		size_t u = i % SHEET, v = i / SHEET;
		if (u < SHEET / 8 || v < SHEET / 8 || u >= SHEET - SHEET / 8 || v >= SHEET - SHEET / 8)
			continue;
		sum += (double)result->direct_irradiance[3 * (first + i)];
		count += 1.0;
	}
	return sum / count / SCENE_PI;
}

/*
 * Rays tell sheets apart that are at least as far from each other as points are: over the middle of
 * the lower one the upper one covers half of the sky but for what comes in at its sides, at most
 * 1 - 0.5 h^2 / (h^2 + r^2) with r the distance to the nearest side and h that between the sheets.
 * Some 200 records of 64 rays, half of which are stopped, make 0.5 % of noise, and their edges as
 * much. Cones are too coarse for what is so near; what they are off by the estimated error says,
 * for which rays stand here: to a quarter, as it is one of some hundred points.
 */
static void test_near_sheets(void **state)
{
	(void)state;
	const double rise[] = { 0.0, 0.4, 1.0 };
	for (size_t k = 0; k < 3; k++) {
		double spacing = SHEET_WIDTH / SHEET * sqrt(sqrt(1.0 + rise[k] * rise[k]));
		double h = 1.7 * spacing, apart = h * sqrt(1.0 + rise[k] * rise[k]);
		double r = SHEET_WIDTH / 8, most = 0.5 + 0.5 * h * h / (h * h + r * r) + 0.02;
		gw_bake_result *rays = bake_pair(apart, rise[k], GW_METHOD_RAYS);
		gw_bake_result *cones = bake_pair(apart, rise[k], GW_METHOD_CONES);
		double below = middle_of(rays, 0), off = 0.0;
		if (!(below > 0.5 - 0.02 && below < most))
			fail_msg("%g of the sky below a sheet that rises by %g", below, rise[k]);
		for (size_t i = 0; i < rays->count; i++)
			off += pow((double)cones->radiance[3 * i] - (double)rays->radiance[3 * i], 2.0);
		off = sqrt(off / (double)rays->count) / scene_mean(rays->radiance, rays->count, 0);
		double stated = cones->report.error.relative_rms;
		if (!(stated > off / 1.25 && stated < off * 1.25))
			fail_msg("cones are off by %g and state %g, rising by %g", off, stated, rise[k]);
		gw_bake_result_destroy(&rays);
		gw_bake_result_destroy(&cones);
	}
}

/* The mean irradiance of the middle of the floor below a panel of emitters of 1 m at a height of
 * 1 m, with a sheet of an opacity between. */
static double below_panel(float sheet, float panel)
{
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	if (sheet > 0.0f)
		add_sheet(&s, 0.4, -1, 0.0, sheet);
	size_t first = s.scene.count;
	add_patch(&s,
			  &(scene_patch){ (double[]){ -0.5, -0.5, 1 }, (double[]){ 0, 1, 0 },
							  (double[]){ 1, 0, 0 }, 24, 24 },
			  0.0f, panel);
	scene_emit(&s.scene, first, (float[]){ 1.0f, 1.0f, 1.0f });
	gw_points points = points_of(&s);
	gw_bake_options options = plain_options();
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	double sum = 0.0, count = 0.0;
	for (size_t i = 0; i < (size_t)FLOOR * FLOOR; i++) {
		if (fabs(points.position[3 * i]) > 0.5 || fabs(points.position[3 * i + 1]) > 0.5)
			continue;
		sum += (double)result->direct_irradiance[3 * i];
		count += 1.0;
	}
	gw_bake_result_destroy(&result);
	clear(&s);
	return sum / count;
}

/* Some 100 records of 64 rays and samples, by which noise is 1 %. The panel's points lie 2.4 times
 * as close as the floor's, by which leaves are as wide as three of them. Points tell to half of
 * their own spacing where a panel ends, of its area to a 24th, and two of noise make 0.06. In
 * closed form it is the integral of 1 / (1 + dx^2 + dy^2)^2 over two squares of 1 m, 0.6278. */
static void test_emitters(void **state)
{
	(void)state;
	double bare = below_panel(0.0f, 1.0f);
	assert_true(fabs(bare / 0.6278 - 1.0) < 0.06);
	assert_true(fabs(below_panel(0.4f, 1.0f) / bare - 0.6) < 0.03);
	assert_true(fabs(below_panel(0.0f, 0.3f) / bare - 0.3) < 0.02);
	assert_true(fabs(below_panel(0.4f, 0.3f) / bare - 0.18) < 0.02);
}

/* A lamp over a sheet in a black box: what the walls and the covered part of the sheet absorb is
 * what the lamp sends, 4 pi I. The sheet faces the lamp, and its back is dark. */
static void test_energy(void **state)
{
	(void)state;
	const float opacity = 0.5f, albedo = 0.8f;
	clear_scene s = { .opacity = NULL };
	scene_add_box(&s.scene, (double[]){ 0, 0, 0 }, (double[]){ 1, 1, 1 }, 32, 0.0f);
	give(&s, 0, 1.0f);
	size_t first = s.scene.count;
	add_patch(&s,
			  &(scene_patch){ (double[]){ 0.15, 0.15, 0.4 }, (double[]){ 0.7, 0, 0 },
							  (double[]){ 0, 0.7, 0 }, 24, 24 },
			  albedo, opacity);
	gw_points points = points_of(&s);
	gw_bake_options options = plain_options();
	options.bounces = GW_BOUNCES_AUTO;
	const gw_light lamp = scene_point_light(0.5, 0.5, 0.7, 1.0f);
	gw_bake_result *result = scene_bake(&points, &lamp, 1, &options);
	double *area = scene_areas(&points), absorbed = 0.0, through = 0.0;
	for (size_t i = 0; i < s.scene.count; i++) {
		double e =
			(double)result->direct_irradiance[3 * i] + (double)result->indirect_irradiance[3 * i];
		absorbed += area[i] * e * (i < first ? 1.0 : (double)(opacity * (1.0f - albedo)));
		through += i < first && points.position[3 * i + 2] < 0.3 ? area[i] * e : 0.0;
	}
	/* The box's edges are rounded by half a spacing, and the lamp's near field by a facet. */
	assert_true(fabs(absorbed / (4.0 * SCENE_PI) - 1.0) < 0.02);
	assert_true(through > 0.5);
	/* What the second reflection starts from: the covered share of the sheet reflects. */
	double sent = 0.0;
	for (size_t i = first; i < s.scene.count; i++)
		sent += area[i] * (double)(opacity * albedo * result->direct_irradiance[3 * i]);
	assert_true(fabs(result->report.bounce[0].energy / sent - 1.0) < 0.03);
	free(area);
	gw_bake_result_destroy(&result);
	clear(&s);
}

static void assert_same(const gw_bake_result *a, const gw_bake_result *b, size_t count)
{
	assert_memory_equal(a->radiance, b->radiance, 3 * count * sizeof(float));
	assert_memory_equal(a->direct_irradiance, b->direct_irradiance, 3 * count * sizeof(float));
	assert_memory_equal(a->indirect_irradiance, b->indirect_irradiance, 3 * count * sizeof(float));
}

/* Opacity 0 is what is not there, and 1 is no opacity at all, to the last bit. */
static void test_ends(void **state)
{
	(void)state;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	add_sheet(&s, 0.5, 1, 0.0, 0.0f);
	const gw_light light[] = { sun_at(30.0),
							   { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } } };
	gw_bake_options options = gw_bake_options_default();
	gw_points points = points_of(&s), floor = points;
	floor.count = (size_t)FLOOR * FLOOR;
	floor.opacity = NULL;
	gw_bake_result *with = scene_bake(&points, light, 2, &options);
	gw_bake_result *without = scene_bake(&floor, light, 2, &options);
	assert_same(with, without, floor.count);
	assert_true(with->radiance[3 * (s.scene.count - 1)] == 0.0f);
	gw_bake_result_destroy(&with);
	gw_bake_result_destroy(&without);
	give(&s, 0, 1.0f);
	points = points_of(&s);
	with = scene_bake(&points, light, 2, &options);
	points.opacity = NULL;
	without = scene_bake(&points, light, 2, &options);
	assert_same(with, without, points.count);
	assert_true(with->report.peak_bytes == without->report.peak_bytes);
	gw_bake_result_destroy(&with);
	gw_bake_result_destroy(&without);
	clear(&s);
}

/* What is forbidden is missing by as much as is known: then nothing gets through a sheet of opacity
 * 0.3, where 0.7 did. Shadow maps, which cannot show it, are not made. */
static void test_other_ways(void **state)
{
	(void)state;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	add_sheet(&s, 0.5, -1, 0.0, 0.3f);
	gw_points points = points_of(&s);
	gw_bake_options plain = plain_options(), maps = plain, opaque = plain;
	const gw_light sun = sun_at(0.0);
	const size_t middle = FLOOR * (FLOOR / 2) + FLOOR / 2;
	maps.shadows = GW_SHADOWS_MAPS;
	opaque.effects_forbidden = 1u << GW_EFFECT_TRANSMISSION;
	gw_bake_result *traced = scene_bake(&points, &sun, 1, &plain);
	gw_bake_result *mapped = scene_bake(&points, &sun, 1, &maps);
	gw_bake_result *dark = scene_bake(&points, &sun, 1, &opaque);
	assert_true(fabsf(traced->direct_irradiance[3 * middle] - 0.7f) < 1e-4f);
	assert_same(traced, mapped, points.count);
	assert_string_equal(scene_effect(&mapped->report, "shadows")->method, "traced");
	assert_true(dark->direct_irradiance[3 * middle] == 0.0f);
	gw_bake_result_destroy(&traced);
	gw_bake_result_destroy(&mapped);
	gw_bake_result_destroy(&dark);
	clear(&s);
}

/* The mean irradiance of the cellar's floor under a sky, with a ceiling of some opacity below. */
static double below_a_hole(float opacity, bool *portal)
{
	clear_scene s = { .opacity = NULL };
	scene_make_cellar(&s.scene);
	give(&s, 0, 1.0f);
	if (opacity > 0.0f)
		add_patch(&s,
				  &(scene_patch){ (double[]){ 0, 0, 0.6 }, (double[]){ 1, 0, 0 },
								  (double[]){ 0, 1, 0 }, 32, 32 },
				  0.5f, opacity);
	return floor_under_sky(&s, GW_METHOD_RAYS, portal);
}

/* Through a portal as through anything. Some hundred records of 12 % scatter each, twice. */
static void test_portal(void **state)
{
	(void)state;
	bool with, without;
	double open = below_a_hole(0.0f, &without), half = below_a_hole(0.5f, &with);
	assert_true(with && without);
	assert_true(fabs(half / open - 0.5) < 0.05);
}

/* A sheet that moves over an opaque floor: each frame has the light of a bake of its own. */
static void test_frames(void **state)
{
	(void)state;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	gw_mover mover = { .first = s.scene.count };
	add_sheet(&s, 0.5, -1, 0.0, 0.3f);
	mover.count = s.scene.count - mover.first;
	gw_points points = points_of(&s);
	double matrix[32] = {
		[0] = 1, [5] = 1, [10] = 1, [15] = 1, [16] = 1, [21] = 1, [26] = 1, [27] = 0.4, [31] = 1
	};
	const gw_motion motion = {
		.mover = &mover, .mover_count = 1, .frame_count = 2, .matrix = matrix
	};
	gw_bake_options options = plain_options();
	scene_choose_passes(&options.passes, &options.validate);
	const gw_light sun = sun_at(20.0);
	gw_frames *frames = NULL;
	gw_error error;
	assert_int_equal(gw_frames_open(&(gw_moving_scene){ { &points, &sun, 1 }, &motion }, &options,
									&(gw_frames_options){ .rebuild = false }, NULL, &frames,
									&error),
					 GW_OK);
	for (size_t f = 0; f < 2; f++) {
		gw_bake_result *result;
		assert_int_equal(gw_frames_bake(frames, f, &sun, 1, &result, &error), GW_OK);
		size_t middle = FLOOR * (FLOOR / 2) + FLOOR / 2;
		double share = (double)result->direct_irradiance[3 * middle] / cos(20 * SCENE_PI / 180.0);
		assert_true(fabs(share - 0.7) < 1e-4);
		gw_bake_result_destroy(&result);
	}
	gw_frames_close(&frames);
	clear(&s);
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

/* A transport holds what lets light through, and knows other opacities, and other shares of what
 * pulses met, from its own. */
static void test_transport(void **state)
{
	(void)state;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	add_sheet(&s, 0.5, -1, 0.0, 0.3f);
	gw_points points = points_of(&s);
	gw_bake_options options = gw_bake_options_default();
	const gw_light sun = sun_at(30.0);
	bytes kept = { NULL, 0 };
	gw_transport transport = { .name = "transport", .write = keep, .user = &kept };
	options.transport = &transport;
	gw_bake_result *first = scene_bake(&points, &sun, 1, &options);
	transport = (gw_transport){ .name = "transport", .data = kept.data, .length = kept.length };
	gw_bake_result *second = scene_bake(&points, &sun, 1, &options);
	assert_same(first, second, points.count);
	gw_bake_result_destroy(&first);
	gw_bake_result_destroy(&second);
	give(&s, (size_t)FLOOR * FLOOR, 0.4f);
	points = points_of(&s);
	const gw_scene_description what = { &points, &sun, 1 };
	gw_error error;
	assert_int_equal(gw_bake(&what, &options, NULL, &second, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "other opacities"));
	give(&s, (size_t)FLOOR * FLOOR, 0.3f);
	points = points_of(&s);
	points.beam_share = points.opacity;
	assert_int_equal(gw_bake(&what, &options, NULL, &second, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "shares of pulses"));
	free(kept.data);
	clear(&s);
}

static void test_bad(void **state)
{
	(void)state;
	clear_scene s = { .opacity = NULL };
	add_floor(&s);
	const gw_light sun = sun_at(0.0);
	const float bad[] = { NAN, -0.1f, 1.1f, INFINITY };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		gw_bake_result *result;
		gw_error error;
		s.opacity[7] = bad[i];
		gw_points points = points_of(&s);
		const gw_scene_description what = { &points, &sun, 1 };
		assert_int_equal(gw_bake(&what, NULL, NULL, &result, &error), GW_ERROR_DATA);
		assert_non_null(strstr(error.text, "opacity of point 7"));
	}
	clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_slab),
		cmocka_unit_test(test_stack),
		cmocka_unit_test(test_rough),
		cmocka_unit_test(test_roof),
		cmocka_unit_test(test_emitters),
		cmocka_unit_test(test_energy),
		cmocka_unit_test(test_ends),
		cmocka_unit_test(test_transport),
		cmocka_unit_test(test_bad),
		cmocka_unit_test(test_other_ways),
		cmocka_unit_test(test_portal),
		cmocka_unit_test(test_frames),
		cmocka_unit_test(test_cones),
		cmocka_unit_test(test_cones_own_light),
		cmocka_unit_test(test_cones_beside_white),
		cmocka_unit_test(test_cones_close_sheets),
		cmocka_unit_test(test_near_sheets),
		cmocka_unit_test(test_map),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
