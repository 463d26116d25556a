/*
 * test_shaders.c - every shader as a GPU would run it: small scenes by shaders alone, under
 * Vulkan's validation layer, first its checks of calls and of what waits for what, then those of
 * each access to memory. Any message is a failure. The light is that of the same bake as it comes,
 * whose CPU kernels the other tests here hold against closed forms.
 *
 * All octrees have one depth, so that a driver which keeps what it has compiled does so once.
 */
#include "glowworm_picture.h"
#include "glowworm_probes.h"
#include "device/passes.h"
#include "picture/render_octree.h"
#include "expected.h"
#include "scenes.h"
#include "cloud/surfels.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define DEPTH 5u

/* Share of the light that rays which go another way may change, see choices_alike of test_passes.c:
 * no more than these by any. Where only planes are looked at, in shadow maps and by cones, shaders
 * do the same in both bakes. */
#define STRAYED 0.012

static bool counting;
static uint64_t elements[GW_PASS_COUNT]; /* that shaders were run over, while counting */

gw_status __wrap_gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
							   const void *push, uint64_t count, gw_error *error);
gw_status __wrap_gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
							   const void *push, uint64_t count, gw_error *error)
{
	gw_pass_way way = gw_passes_way(passes, id);
	if (counting) {
		assert_int_equal(way, GW_WAY_DEVICE);
		elements[id] += count;
	}
	if (way == GW_WAY_DEVICE)
		return gw_passes_run_shader(passes, id, bindings, push, count, error);
	gw_passes_run_kernel(passes, id, bindings, push, count);
	return GW_OK;
}

/* -------------------------------------------------------------------------------------- bakes */

static gw_bake_options few(void)
{
	counting = false; /* after a failure */
	gw_bake_options options = gw_bake_options_default();
	options.depth = DEPTH;
	options.rays = options.light_samples = 16;
	options.bounces = 2;
	options.estimate_points = 50;
	return options;
}

static double difference(const float *a, const float *b, size_t count)
{
	double off = 0.0, sum = 0.0;
	for (size_t i = 0; i < count; i++) {
		off += fabs((double)a[i] - (double)b[i]);
		sum += fabs((double)a[i]);
	}
	assert_true(sum > 0.0);
	return off / sum;
}

/* Bakes as it comes and by shaders, and compares. */
static void compare_bakes(const scene *s, const gw_light *light, size_t lights,
						  const gw_bake_options *options, gw_validation kind)
{
	const gw_points points = scene_points(s);
	gw_bake_options by_shaders = *options;
	gw_bake_result *expected = scene_bake(&points, light, lights, options), *found;
	gw_error error = { 0 };
	by_shaders.passes = GW_PASSES_DEVICE;
	by_shaders.validate = kind;
	counting = true;
	gw_status status = gw_bake(&(gw_scene_description){ &points, light, lights }, &by_shaders, NULL,
							   &found, &error);
	counting = false;
	assert_ok_validated(status, &error);
	double off = difference(expected->radiance, found->radiance, 3 * points.count);
	if (!(off <= STRAYED))
		fail_msg("light by shaders is off by %.2g of itself", off);
	gw_bake_result_destroy(&expected);
	gw_bake_result_destroy(&found);
}

/* A hall that is open at one side, with points that emit: shadow maps, cones, voxels. */
static void hall_by_cones(void **state)
{
	scene s = { 0 };
	const gw_light light = scene_point_light(1.0, 1.0, 1.2, 2.0f);
	gw_bake_options options = few();
	options.method = GW_METHOD_CONES;
	options.shadows = GW_SHADOWS_MAPS;
	options.voxels = true;
	options.shadow_map_size = 64;
	options.estimate_points = 0;
	scene_make_small_hall(&s);
	compare_bakes(&s, &light, 1, &options, *(gw_validation *)*state);
	scene_clear(&s);
}

static void hall_by_cells(gw_method method, gw_validation kind)
{
	scene s = { 0 };
	const gw_light light = scene_point_light(1.0, 1.0, 1.2, 2.0f);
	gw_bake_options options = few();
	options.method = method;
	options.volume_cells = 8;
	options.estimate_points = 0;
	scene_make_small_hall(&s);
	compare_bakes(&s, &light, 1, &options, kind);
	scene_clear(&s);
}

/* The same hall by a radiance volume. */
static void hall_by_volume(void **state)
{
	hall_by_cells(GW_METHOD_VOLUME, *(gw_validation *)*state);
}

/* And by light that goes from cell to cell. */
static void hall_by_propagation(void **state)
{
	hall_by_cells(GW_METHOD_LPV, *(gw_validation *)*state);
}

/* ------------------------------------------------------------------------------------- frames */

enum { FRAMES = 2, LIGHTS = 2 };

/* The last frame. */
static gw_bake_result *bake_frames(const scene *s, const gw_mover *ball,
								   const gw_light light[LIGHTS], const gw_bake_options *options)
{
	double matrix[16 * FRAMES] = { 0 };
	const gw_points points = scene_points(s);
	const gw_motion motion = { ball, 1, FRAMES, matrix };
	const gw_frames_options how = { .independent = true };
	gw_frames *frames = NULL;
	gw_bake_result *result = NULL;
	gw_error error = { 0 };
	for (size_t i = 0; i < FRAMES; i++) {
		for (size_t k = 0; k < 4; k++)
			matrix[16 * i + 5 * k] = 1.0;
		matrix[16 * i + 3] = 0.3 * (double)i;
	}
	gw_status status = gw_frames_open(&(gw_moving_scene){ { &points, light, LIGHTS }, &motion },
									  options, &how, NULL, &frames, &error);
	for (size_t i = 0; i < FRAMES && status == GW_OK; i++) {
		gw_bake_result_destroy(&result);
		status = gw_frames_bake(frames, i, light, LIGHTS, &result, &error);
	}
	gw_frames_close(&frames);
	assert_ok_validated(status, &error);
	return result;
}

/* Nearly all at once, since the layer makes shaders slow to compile: a sky with a map shines into a
 * cellar by a hole, a lamp has an extent, a ball whose points emit moves there, so that rays keep
 * their hits or are traced again, and records know from where their light comes. */
static void frames_of_a_cellar(void **state)
{
	scene s = { 0 };
	float pixel[16 * 8 * 3];
	gw_bake_options options = few();
	scene_make_cellar(&s);
	const gw_mover ball = { .first = s.count, .count = 300 };
	scene_add_sphere(&s, (double[3]){ 0.3, 0.4, 0.4 }, 0.15, ball.count, 1, 0.5f);
	scene_emit(&s, s.count - 20, (float[3]){ 1, 1, 1 });
	for (size_t i = 0; i < sizeof pixel / sizeof *pixel; i++)
		pixel[i] = (float)scene_random(&s);
	gw_light light[LIGHTS] = { scene_point_light(0.5, 0.7, 0.8, 0.1f),
							   { .type = GW_LIGHT_ENVIRONMENT,
								 .radiance = { 1, 1, 1 },
								 .map = pixel,
								 .map_width = 16,
								 .map_height = 8 } };
	light[0].radius = 0.05f;
	options.basis = GW_BASIS_DIRECTIONAL;
	gw_bake_result *expected = bake_frames(&s, &ball, light, &options);
	options.passes = GW_PASSES_DEVICE;
	options.validate = *(gw_validation *)*state;
	counting = true;
	gw_bake_result *found = bake_frames(&s, &ball, light, &options);
	counting = false;
	double off = difference(expected->radiance, found->radiance, 3 * s.count);
	if (!(off <= STRAYED))
		fail_msg("light by shaders is off by %.2g of itself", off);
	gw_bake_result_destroy(&expected);
	gw_bake_result_destroy(&found);
	scene_clear(&s);
}

/* ----------------------------------------------------------------------------------- pictures */

#define PIXELS 64u

/* Along given rays, each the normal of a pixel, all is 1. */
static void look_outwards(gw_render_octree *octree, const gw_pixels *pixels)
{
	float seen[4 * PIXELS];
	gw_error error = { 0 };
	const gw_given_rays rays = { *pixels, pixels->normal };
	assert_ok_validated(
		gw_given_rays_trace(octree, &rays, &(gw_reflection){ .rays = 1 }, seen, &error), &error);
	for (size_t i = 0; i < PIXELS; i++)
		if (!(fabsf(seen[4 * i] - 1.0f) <= 1e-5f))
			fail_msg("ray %zu sees %.5f", i, (double)seen[4 * i]);
}

/* What pixels in the middle of a sphere see of it by shaders: of a ball there that reflects all, by
 * rays, by a cone, and unless accesses are looked at by caches, of voxels, and what cells show. It
 * glows evenly with 1, and so do they; cones are not full where their last step ends, by 3 %
 * (test_furnace.c), and of 16 rays one may slip between planes, as of 32 looks into a cache. */
static void look_around(gw_render_octree *octree, const gw_surfels *surfels, bool caches)
{
	float position[4 * PIXELS] = { 0 }, normal[4 * PIXELS] = { 0 }, seen[4 * PIXELS];
	uint32_t place[PIXELS];
	gw_pixels pixels = { .count = PIXELS,
						 .position = position,
						 .normal = normal,
						 .place = place,
						 .width = PIXELS,
						 .height = 1,
						 .step = 1.0f / PIXELS };
	const gw_reflection way[] = { { .rays = 16 },
								  { .rays = 1, .cone = true },
								  { .rays = 1, .caches = true } };
	const float off[] = { 1.0f / 16.0f + 1e-5f, 0.03f, 1.0f / 16.0f + 1e-5f };
	gw_error error = { 0 };
	for (uint32_t i = 0; i < PIXELS; i++) {
		place[i] = i;
		double turn = 2.0 * SCENE_PI * (double)i / PIXELS;
		const double out[3] = { cos(turn), sin(turn), 0.0 };
		for (size_t k = 0; k < 3; k++) {
			position[4 * i + k] = (float)(0.2 * out[k] - surfels->origin[k]);
			normal[4 * i + k] = (float)out[k];
			pixels.eye[k] = (float)((k == 0 ? 0.6 : 0.0) - surfels->origin[k]);
		}
		position[4 * i + 3] = 0.5f;
		normal[4 * i + 3] = 1.0f;
	}
	for (size_t w = 0; w < (caches ? 3 : 2); w++) {
		assert_int_equal(gw_render_octree_reflect(octree, &pixels, &way[w], seen, &error), GW_OK);
		for (size_t i = 0; i < 16; i++)
			if (!(fabsf(seen[4 * i] - 1.0f) <= off[w]))
				fail_msg("way %zu: pixel %zu sees %.5f", w, i, (double)seen[4 * i]);
	}
	if (caches)
		look_outwards(octree, &pixels);
	for (size_t k = 0; k < 3; k++)
		pixels.eye[k] = (float)-surfels->origin[k];
	for (size_t i = 0; i < PIXELS; i++)
		for (size_t k = 0; k < 3; k++) {
			position[4 * i + k] +=
				0.8f * normal[4 * i + k]; /* on the sphere, which faces inwards */
			normal[4 * i + k] = -normal[4 * i + k];
		}
	assert_int_equal(gw_render_octree_read(octree, &pixels, false, seen, &error), GW_OK);
	for (size_t i = 0; i < PIXELS; i++)
		if (!(fabsf(seen[4 * i] - 1.0f) <= 0x1p-10f)) /* half floats */
			fail_msg("voxels around pixel %zu show %.5f", i, (double)seen[4 * i]);
}

static void look_at_cells(gw_render_octree *octree)
{
	gw_cells cells;
	gw_error error = { 0 };
	size_t shown_cells = 0;
	assert_int_equal(gw_cells_list(octree, DEPTH, &cells, &error), GW_OK);
	float *shown = calloc(cells.count, 4 * sizeof *shown);
	assert_non_null(shown);
	assert_int_equal(gw_cells_show(octree, &cells, DEPTH, 0, shown, &error), GW_OK);
	for (size_t i = 0; i < cells.count; i++) {
		shown_cells += shown[4 * i + 3] > 0.0f;
		assert_true(shown[4 * i + 3] == 0.0f || fabsf(shown[4 * i] - 1.0f) <= 0x1p-9f);
	}
	assert_true(shown_cells > cells.count / 4);
	free(shown);
	gw_cells_clear(&cells);
}

static void pictures(void **state)
{
	scene s = { 0 };
	gw_surfels surfels;
	gw_render_octree *octree = NULL;
	gw_error error = { 0 };
	const gw_render_octree_options how = { .depth = DEPTH,
										   .leaf_spacing = GW_LEAF_SPACING,
										   .bricks = true,
										   .passes = GW_PASSES_DEVICE,
										   .validate = *(gw_validation *)*state };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, 4000, -1, 0.5f);
	const gw_points points = scene_points(&s);
	assert_int_equal(gw_surfels_make(&points, &(gw_surfels_options){ 0 }, &surfels, &error), GW_OK);
	float *radiance = calloc(surfels.count, 3 * sizeof *radiance);
	assert_non_null(radiance);
	for (size_t i = 0; i < 3 * surfels.count; i++)
		radiance[i] = 1.0f;
	counting = true;
	assert_ok_validated(gw_render_octree_create(&surfels, radiance, &how, &octree, &error), &error);
	look_around(octree, &surfels, how.validate != GW_VALIDATE_ACCESSES);
	look_at_cells(octree);
	counting = false;
	gw_render_octree_destroy(&octree);
	gw_surfels_clear(&surfels);
	scene_clear(&s);
	free(radiance);
}

/* ------------------------------------------------------------------------------------- probes */

/* What probes see of a box whose points send out 1 is 1, where rays do not slip through: 0.08 % do
 * where leaves are fine, and at edges of such a coarse octree some more. */
#define PROBE_SLIPPED 0.01

static void probes_of_a_box(void **state)
{
	scene s = { 0 };
	gw_bake_options options = few();
	gw_probes_options how = gw_probes_options_default();
	gw_scene *prepared = NULL;
	gw_lighting *lighting = NULL;
	gw_probes *probes = NULL;
	gw_error error = { 0 };
	size_t slipped = 0;
	how.size = 8;
	how.moves = 2;
	options.bounces = 0;
	options.estimate_points = 0;
	options.effects_forced |= 1u << GW_EFFECT_OCTREE;
	options.passes = GW_PASSES_DEVICE;
	options.validate = *(gw_validation *)*state;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 16, 0.5f);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	const gw_points points = scene_points(&s);
	const gw_scene_description description = { &points, NULL, 0 };
	counting = true;
	gw_status status = gw_scene_create(&description, &options, NULL, &prepared, &error);
	if (status == GW_OK)
		status = gw_lighting_create(prepared, NULL, 0, &lighting, &error);
	if (status == GW_OK)
		status = gw_probes_make(lighting, &how, &probes, &error);
	counting = false;
	assert_ok_validated(status, &error);
	const size_t texels = probes->count * how.size * how.size;
	for (size_t i = 0; i < texels; i++)
		slipped += fabsf(probes->radiance[3 * i] - 1.0f) > 1e-5f;
	if (!((double)slipped <= PROBE_SLIPPED * (double)texels))
		fail_msg("%zu of %zu texels do not show 1", slipped, texels);
	gw_probes_destroy(&probes);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&prepared);
	scene_clear(&s);
}

/* ---------------------------------------------------------------------------------------- all */

/* Volumes, probes, caches and given rays, whose accesses are not looked at: it takes minutes to
 * compile for that. */
static bool is_costly(int id)
{
	return (id >= GW_PASS_VOLUME_RAYS && id <= GW_PASS_PROBE_RAYS) || id == GW_PASS_GIVEN_RAYS ||
		   (id >= GW_PASS_CACHE_RAYS && id <= GW_PASS_PIXEL_CACHES);
}

/* Each shader of the table was run by these scenes. */
static void none_left_out(void **state)
{
	uint64_t sum = 0;
	bool accesses = *(gw_validation *)*state == GW_VALIDATE_ACCESSES;
	for (int id = 0; id < GW_PASS_COUNT; id++)
		sum += elements[id];
	if (sum == 0)
		skip();
	for (int id = 0; id < GW_PASS_COUNT; id++)
		if (elements[id] == 0 && !(accesses && is_costly(id)))
			fail_msg("no scene here runs %s", gw_pass_row_of((gw_pass_id)id)->shader);
	memset(elements, 0, sizeof elements);
}

int main(void)
{
	static gw_validation kind[] = { GW_VALIDATE_CALLS, GW_VALIDATE_ACCESSES };
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(frames_of_a_cellar, &kind[0]),
		cmocka_unit_test_prestate(hall_by_cones, &kind[0]),
		cmocka_unit_test_prestate(hall_by_volume, &kind[0]),
		cmocka_unit_test_prestate(hall_by_propagation, &kind[0]),
		cmocka_unit_test_prestate(pictures, &kind[0]),
		cmocka_unit_test_prestate(probes_of_a_box, &kind[0]),
		cmocka_unit_test_prestate(none_left_out, &kind[0]),
		cmocka_unit_test_prestate(frames_of_a_cellar, &kind[1]),
		cmocka_unit_test_prestate(hall_by_cones, &kind[1]),
		cmocka_unit_test_prestate(pictures, &kind[1]),
		cmocka_unit_test_prestate(none_left_out, &kind[1]),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
