/*
 * test_leaks.c - suns, lamps, a sky and what glows outside of closed rock: no point within sees
 * them.
 *
 * Spheres and boxes of points at random places, seen from within. Whatever light arrives is a leak,
 * so what is expected is zero, without a tolerance. And windows stay open: what is shut out by
 * mistake is darker than any leak is bright.
 */
#include "device/gpu.h"
#include "octree/compartments.h"
#include "octree/octree.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define SUNS 6

/* A normal distribution's sample, by Box and Muller. */
static double scene_normal(scene *s)
{
	double radius = sqrt(-2.0 * log(1.0 - scene_random(s)));
	return radius * cos(2.0 * SCENE_PI * scene_random(s));
}

/* A unit sphere of points at random places; noise along the normal in spacings. */
static void add_random_sphere(scene *s, size_t count, double noise)
{
	double spacing = sqrt(4.0 * SCENE_PI / (double)count);
	for (size_t i = 0; i < count; i++) {
		double way[3], place[3], normal[3], squared = 0.0;
		for (int k = 0; k < 3; k++) {
			way[k] = scene_normal(s);
			squared += way[k] * way[k];
		}
		double off = noise > 0.0 ? noise * spacing * scene_normal(s) : 0.0;
		for (int k = 0; k < 3; k++) {
			normal[k] = -way[k] / sqrt(squared);
			place[k] = normal[k] * (off - 1.0);
		}
		scene_add(s, place, normal, 0.5f);
	}
}

/* A box of points. */
typedef struct box {
	size_t count;
	double about_x, about_z; /* it is turned by these angles, about x first */
	double noise;            /* along the normals, spacings */
	double shake;            /* the same in all directions, so that walls' edges stick out */
	double width;            /* 1, but for the outside of a wall around another */
	double window;           /* width of a square without points in the middle of its top */
	double dense;            /* so many times as dense where x is above 0 */
	int facing;              /* 1: normals inward */
} box;

/* A cube around the origin, each side of points at random places. */
static void add_random_box(scene *s, box b)
{
	double about_x = b.about_x, about_z = b.about_z;
	double spacing = sqrt(6.0 / (double)b.count);
	const double turn[3][3] = {
		{ cos(about_z), -sin(about_z) * cos(about_x), sin(about_z) * sin(about_x) },
		{ sin(about_z), cos(about_z) * cos(about_x), -cos(about_z) * sin(about_x) },
		{ 0.0, sin(about_x), cos(about_x) },
	};
	for (size_t i = 0; i < b.count; i++) {
		size_t axis = i % 3;
		double side = i % 6 < 3 ? -1.0 : 1.0, flat[3], place[3], normal[3];
		for (int k = 0; k < 3; k++)
			flat[k] = scene_random(s) - 0.5;
		double off = b.noise > 0.0 ? b.noise * spacing * scene_normal(s) : 0.0;
		bool sparse = b.dense > 1.0 && flat[0] < 0.0;
		if (sparse && scene_random(s) * b.dense > 1.0)
			continue;
		if (axis == 2 && side > 0.0 && fmax(fabs(flat[0]), fabs(flat[1])) < 0.5 * b.window)
			continue;
		flat[axis] = 0.5 * side + off;
		for (int k = 0; k < 3 && b.shake > 0.0; k++)
			flat[k] += b.shake * spacing * scene_normal(s);
		for (int k = 0; k < 3; k++) {
			normal[k] = -side * b.facing * turn[k][axis];
			place[k] =
				b.width * (turn[k][0] * flat[0] + turn[k][1] * flat[1] + turn[k][2] * flat[2]);
		}
		scene_add(s, place, normal, 0.5f);
	}
}

/* Of the first `count` points those that get light from a sun at some height, degrees, of six
 * around. */
static size_t count_sunlit_of(const scene *s, size_t count, double height, uint32_t depth)
{
	gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	options.bounces = 1;
	options.rays = 1; /* suns are looked at, not what bounces */
	options.estimate_points = 0;
	options.depth = depth;
	gw_light sun[SUNS];
	for (int i = 0; i < SUNS; i++) {
		double turn = 2.0 * SCENE_PI * (i + 0.3) / SUNS, up = height * SCENE_PI / 180.0;
		sun[i] = (gw_light){ .type = GW_LIGHT_SUN,
							 .direction = { -cos(up) * cos(turn), -cos(up) * sin(turn), -sin(up) },
							 .irradiance = { 1.0f, 1.0f, 1.0f } };
	}
	gw_bake_result *result = scene_bake(&points, sun, SUNS, &options);
	size_t lit = 0;
	for (size_t i = 0; i < count; i++)
		lit += result->direct_irradiance[3 * i] > 0.0f;
	gw_bake_result_destroy(&result);
	return lit;
}

static size_t count_sunlit(const scene *s, double height, uint32_t depth)
{
	return count_sunlit_of(s, s->count, height, depth);
}

/* Of the first `count` points those that get more light than some from a sky, a lamp at
 * (2, 1, 3), or bounces. */
static size_t count_lit_with(const scene *s, size_t count, gw_bake_options options, float some)
{
	gw_points points = scene_points(s);
	const gw_light light[2] = { { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1.0f, 1.0f, 1.0f } },
								scene_point_light(2.0, 1.0, 3.0, 10.0f) };
	gw_bake_result *result = scene_bake(&points, light, 2, &options);
	size_t lit = 0;
	for (size_t i = 0; i < count; i++)
		lit += result->direct_irradiance[3 * i] + result->indirect_irradiance[3 * i] > some;
	gw_bake_result_destroy(&result);
	return lit;
}

static size_t count_lit_by(const scene *s, size_t count, gw_method method, float some)
{
	gw_bake_options options = gw_bake_options_default();
	options.estimate_points = 0;
	options.method = method;
	if (method == GW_METHOD_VOLUME || method == GW_METHOD_LPV)
		options.rays = 16; /* of a cell: one that belongs to the wrong side lights all around it */
	return count_lit_with(s, count, options, some);
}

static size_t count_lit(const scene *s, size_t count)
{
	return count_lit_by(s, count, GW_METHOD_RAYS, 0.0f);
}

static void expect_dark(size_t count, double noise, double height, uint32_t depth)
{
	scene s = { 0 };
	add_random_sphere(&s, count, noise);
	size_t lit = count_sunlit(&s, height, depth);
	print_message("%zu points, noise %.2f, sun at %.0f degrees, depth %u: %zu lit\n", count, noise,
				  height, depth, lit);
	scene_clear(&s);
	assert_int_equal(lit, 0);
}

static void closed_spheres_stay_dark(void **state)
{
	(void)state;
	expect_dark(3000, 0.0, 40.0, GW_DEPTH_AUTO);
	if (scene_by_shaders())
		return;
	expect_dark(3000, 0.0, 5.0, GW_DEPTH_AUTO);
	expect_dark(3000, 0.5, 70.0, GW_DEPTH_AUTO);
	expect_dark(20000, 0.0, 20.0, GW_DEPTH_AUTO);
}

static void at_other_depths(void **state)
{
	(void)state;
	for (uint32_t depth = 4; depth <= 10; depth += 2)
		expect_dark(3000, 0.25, 40.0, depth);
}

static void expect_dark_box(box b, double height)
{
	scene s = { 0 };
	add_random_box(&s, b);
	size_t lit = count_sunlit(&s, height, GW_DEPTH_AUTO);
	print_message("%zu points, box turned by %.1f and %.1f, noise %.2f, sun at %.0f degrees: "
				  "%zu lit\n",
				  s.count, b.about_x, b.about_z, b.noise, height, lit);
	scene_clear(&s);
	assert_int_equal(lit, 0);
}

/* Rays pass where two walls meet, and where a corner has no point near. */
static void closed_boxes_stay_dark(void **state)
{
	(void)state;
	box b = { .count = 10000, .width = 1.0, .facing = 1 };
	for (int height = 10; height < 90; height += 25) {
		b.about_x = b.about_z = 0.0;
		expect_dark_box(b, height);
		b.about_x = 0.8;
		b.about_z = 0.5;
		expect_dark_box(b, height);
		b.about_x = 0.02 * height;
		b.noise = 0.25 * (height % 3);
		expect_dark_box(b, height);
	}
}

/* What sticks out beyond the edge of its wall lies in the sun. */
static void with_noisy_edges(void **state)
{
	(void)state;
	for (double turn = 0.0; turn < 0.8; turn += 0.3) {
		box b = { .count = 20000, .width = 1.0, .facing = 1, .about_x = turn, .shake = 0.5 };
		expect_dark_box(b, 35.0);
	}
}

/* Where one half of the walls is many times sparser than the other one. */
static void unevenly_sampled_ones_as_well(void **state)
{
	(void)state;
	box b = { .count = 30000, .width = 1.0, .facing = 1, .about_x = 0.3, .about_z = 0.9 };
	for (b.dense = 3.0; b.dense < 10.0; b.dense *= 3.0)
		expect_dark_box(b, 35.0);
	for (b.dense = 20.0; b.dense < 50.0; b.dense *= 2.0) {
		expect_dark_box(b, 10.0);
		expect_dark_box(b, 60.0);
	}
	b.about_x = b.about_z = 0.0;
	b.dense = 20.0;
	expect_dark_box(b, 35.0);
	b.count = 10000; /* the sparse half is no wider than four of its spacings */
	b.dense = 30.0;
	expect_dark_box(b, 35.0);
}

static void sky_and_lamps_stay_outside(void **state)
{
	(void)state;
	box b = { .count = 10000, .width = 1.0, .facing = 1, .about_x = 0.8, .about_z = 0.5 };
	for (int i = 0; i < 4; i++, b.noise += 0.25) {
		scene s = { 0 };
		if (i == 3) { /* one half 20 times as sparse */
			b.count = 30000;
			b.dense = 20.0;
			b.noise = 0.0;
		}
		add_random_box(&s, b);
		size_t lit = count_lit(&s, s.count);
		print_message("%zu points, noise %.2f: %zu lit\n", s.count, b.noise, lit);
		scene_clear(&s);
		assert_int_equal(lit, 0);
	}
}

/* How many points of a closed box of random points are lit at that depth. */
static size_t count_lit_at_depth(size_t points, uint32_t depth, uint64_t seed)
{
	scene s = { .state = seed };
	gw_bake_options options = gw_bake_options_default();
	options.estimate_points = 0;
	options.depth = depth;
	add_random_box(&s, (box){ points, .width = 1, .facing = 1, .about_x = 0.8, .about_z = 0.5 });
	size_t lit = count_lit_with(&s, s.count, options, 0.0f);
	print_message("%zu points, depth %u: %zu lit\n", points, depth, lit);
	scene_clear(&s);
	return lit;
}

/* Nor do octrees let light in that are up to 6 levels deeper than their points ask for. */
static void at_any_depth(void **state)
{
	(void)state;
	const uint32_t depths[] = { 7, 8, 10, 12 };
	for (size_t i = 0; i < sizeof depths / sizeof *depths; i++)
		assert_int_equal(count_lit_at_depth(3000, depths[i], depths[i]), 0);
	for (uint64_t seed = 1; seed <= 10; seed++)
		assert_int_equal(count_lit_at_depth(600, 7, seed), 0);
}

/* Cones are wider than gaps in rock. */
static void cones_see_no_sky(void **state)
{
	(void)state;
	box b = { .count = 6000, .width = 1.0, .facing = 1, .about_x = 0.8, .about_z = 0.5 };
	scene s = { 0 };
	add_random_box(&s, b);
	size_t lit = count_lit_by(&s, s.count, GW_METHOD_CONES, 0.0f);
	scene_clear(&s);
	assert_int_equal(lit, 0);
}

/* Of the first `count` points those that get light from points that glow, or from a lamp. */
static size_t count_lit_by_others(const scene *s, size_t count, const gw_light *lamp,
								  gw_method method)
{
	gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	options.estimate_points = 0;
	options.bounces = 3;
	options.method = method;
	if (method == GW_METHOD_VOLUME || method == GW_METHOD_LPV)
		options.rays = 16; /* of a cell: one that belongs to the wrong side lights all around it */
	gw_bake_result *result = scene_bake(&points, lamp, lamp ? 1 : 0, &options);
	size_t lit = 0;
	for (size_t i = 0; i < count; i++)
		lit += result->direct_irradiance[3 * i] + result->indirect_irradiance[3 * i] > 0.0f;
	gw_bake_result_destroy(&result);
	print_message("%zu points, by %s: %zu lit\n", count, gw_method_name(method), lit);
	return lit;
}

static void expect_no_glow_within(const scene *s, size_t inside, const gw_light *lamp)
{
	assert_int_equal(count_lit_by_others(s, inside, lamp, GW_METHOD_RAYS), 0);
	assert_int_equal(count_lit_by_others(s, inside, lamp, GW_METHOD_CONES), 0);
	if (scene_by_shaders())
		return; /* what these add to it is found on the CPU, and takes them ten times as long */
	assert_int_equal(count_lit_by_others(s, inside, lamp, GW_METHOD_VOLUME), 0);
	assert_int_equal(count_lit_by_others(s, inside, lamp, GW_METHOD_LPV), 0);
}

static const float glow[3] = { 5.0f, 5.0f, 5.0f };

/* Samples of a glowing plate that faces the box find ways through its noise, and cones see more of
 * its coarse voxels than of the walls before them. */
static void what_glows_outside_stays_there(void **state)
{
	(void)state;
	box b = { .count = 10000, .width = 1.0, .facing = 1, .about_x = 0.8, .about_z = 0.5 };
	for (b.noise = 0.0; b.noise < 0.7; b.noise += 0.5) {
		scene s = { 0 };
		add_random_box(&s, b);
		size_t inside = s.count;
		scene_add_patch(&s,
						&(scene_patch){ (double[3]){ 1.6, -0.3, -0.3 },
										(double[3]){ 0.0, 0.0, 0.6 }, (double[3]){ 0.0, 0.6, 0.0 },
										24, 24 },
						0.5f);
		scene_emit(&s, inside, glow);
		expect_no_glow_within(&s, inside, NULL);
		scene_clear(&s);
	}
}

/* The outside of a wall around a box glows; four spacings of rock lie between. */
static void nor_through_walls_with_two_sides(void **state)
{
	(void)state;
	box b = { .count = 6000, .width = 1.0, .facing = 1, .about_x = 0.8, .about_z = 0.5 };
	scene s = { 0 };
	add_random_box(&s, b);
	size_t inside = s.count;
	b.width = 1.0 + 8.0 * sqrt(6.0 / (double)b.count);
	b.count = (size_t)((double)b.count * b.width * b.width);
	b.facing = -1;
	add_random_box(&s, b);
	scene_emit(&s, inside, glow);
	expect_no_glow_within(&s, inside, NULL);
	scene_clear(&s);
}

/* Two rooms beside each other, four spacings apart, a lamp in the second one. */
static void nor_what_a_lamp_lights_next_door(void **state)
{
	(void)state;
	box b = { .count = 6000, .width = 1.0, .facing = 1 };
	scene s = { 0 };
	add_random_box(&s, b);
	size_t inside = s.count;
	double off = 1.0 + 4.0 * sqrt(6.0 / (double)b.count);
	add_random_box(&s, b);
	for (size_t i = inside; i < s.count; i++)
		s.position[3 * i] += off;
	const gw_light lamp = scene_point_light(off, 0.1, 0.2, 10.0f);
	expect_no_glow_within(&s, inside, &lamp);
	scene_clear(&s);
}

/* What a late bounce has of the one before it, over the albedo: 1 where no ray gets lost. */
static double share_kept(const scene *s)
{
	gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	options.estimate_points = 0;
	options.bounces = 40;
	const gw_light lamp = scene_point_light(0.05, 0.1, 0.0, 10.0f);
	gw_bake_result *result = scene_bake(&points, &lamp, 1, &options);
	const gw_report *report = &result->report;
	assert_true(report->bounce_count == 40);
	double kept = report->bounce[39].energy / report->bounce[38].energy / 0.98;
	gw_bake_result_destroy(&result);
	return kept;
}

/* Nor does light get out, which white walls would reflect 50 times: a ray in 4,000 that slips
 * through is a percent of all light. Energies are sums of a few thousand floats. */
static void white_rooms_keep_their_light(void **state)
{
	(void)state;
	for (uint64_t seed = 0; seed < 4; seed++) {
		scene s = { .state = 1000003u * seed };
		add_random_box(&s, (box){ .count = 3000, .width = 1.0, .facing = 1, .about_x = 0.3 });
		for (size_t i = 0; i < 3 * s.count; i++)
			s.albedo[i] = 0.98f;
		double kept = share_kept(&s);
		print_message("a white room keeps %.6f of its light\n", kept);
		scene_clear(&s);
		assert_true(fabs(kept - 1.0) < 2e-5);
	}
}

/* Inside and outside of a wall around a box, some spacings apart. Returns how many of the points
 * within get more light than some, about 3 of which falls on those outside. */
static size_t count_lit_within(double spacings, double turn, gw_method method, float some)
{
	box b = { .count = 6000, .width = 1.0, .facing = 1, .about_x = turn, .about_z = 0.6 * turn };
	scene s = { 0 };
	add_random_box(&s, b);
	size_t inside = s.count;
	b.width = 1.0 + 2.0 * spacings * sqrt(6.0 / (double)b.count);
	b.count = (size_t)((double)b.count * b.width * b.width);
	b.facing = -1;
	add_random_box(&s, b);
	size_t lit = count_lit_by(&s, inside, method, some);
	print_message("wall of %.2f spacings, turned by %.1f, by %s: %zu of %zu over %g\n", spacings,
				  turn, gw_method_name(method), lit, inside, some);
	scene_clear(&s);
	return lit;
}

static void walls_with_two_sides_shut_out(void **state)
{
	(void)state;
	const double thickest = scene_by_shaders() ? 2.0 : 8.0;
	for (double spacings = 2.0; spacings <= thickest; spacings *= 2.0)
		assert_int_equal(count_lit_within(spacings, 0.8, GW_METHOD_RAYS, 0.0f), 0);
}

/* Sides closer than a spacing lie in the same cells, and where walls meet in the same facets. But
 * facets have the light of what looks into one compartment alone, and records are read by no
 * surface of another one. Before, a wall of a quarter let 0.3 % of the sun's light in. */
static void so_do_walls_thinner_than_cells(void **state)
{
	(void)state;
	for (double spacings = 0.25; spacings < 1.5; spacings *= 2.0) {
		assert_int_equal(count_lit_within(spacings, 0.8, GW_METHOD_RAYS, 0.0f), 0);
		assert_int_equal(count_lit_within(spacings, 0.0, GW_METHOD_RAYS, 0.0f), 0);
	}
}

/* Nor does anything else happen where both sides glow but emitters are forbidden: facets have no
 * emission then from which that of another compartment would have to be taken. */
static void so_do_those_that_only_show_their_glow(void **state)
{
	(void)state;
	scene s = { 0 };
	box b = { .count = 6000, .width = 1.0, .facing = 1 };
	add_random_box(&s, b);
	size_t inside = s.count;
	b.width = 1.0 + 0.5 * sqrt(6.0 / 6000.0);
	b.facing = -1;
	add_random_box(&s, b);
	scene_emit(&s, 0, glow);
	gw_bake_options options = gw_bake_options_default();
	options.estimate_points = 0;
	options.effects_forbidden = 1u << GW_EFFECT_EMITTERS;
	assert_int_equal(count_lit_with(&s, inside, options, 0.0f), 0);
	scene_clear(&s);
}

/* With noise of half a spacing both sides of a wall a tenth of that thick lie in each other. At the
 * foot of a wall its outside outvoted the points of the floor, all of which look into the room. */
static void noise_changes_no_sides(void **state)
{
	(void)state;
	size_t lit = 0;
	/* Of 24 seeds those eight that were lit before, and four more; the last ones turn the boxes. */
	const uint64_t seeds[] = { 0, 1, 2, 3, 6, 8, 12, 13, 16, 17, 18, 19 };
	for (size_t i = 0; i < sizeof seeds / sizeof *seeds; i++) {
		uint64_t seed = seeds[i];
		scene s = { .state = 777u * (seed + 1) };
		box b = { .count = 6000, .width = 1.0, .facing = 1, .noise = 0.5 };
		b.about_x = b.about_z = seed < 16 ? 0.0 : 0.7;
		add_random_box(&s, b);
		size_t inside = s.count;
		b.width = 1.0 + 0.2 * (double)(1 + seed % 4) * sqrt(6.0 / 6000.0);
		b.count = (size_t)(6000.0 * b.width * b.width);
		b.noise /= b.width; /* in spacings of the inner box */
		b.facing = -1;
		add_random_box(&s, b);
		lit += count_sunlit_of(&s, inside, 40.0, GW_DEPTH_AUTO);
		scene_clear(&s);
	}
	print_message("behind walls of 0.1 to 0.4 spacings with noise: %zu lit\n", lit);
	assert_int_equal(lit, 0);
}

/* The centres of some cells of a grid lie in the wall, and see what lies on both of its sides. Each
 * belongs to one side. Before, places of both sides read them, and all points within were lit. */
static void cells_in_walls_belong_to_one_side(void **state)
{
	(void)state;
	for (double spacings = 0.25; spacings < 5.0; spacings *= 4.0)
		for (int method = GW_METHOD_VOLUME; method <= GW_METHOD_LPV; method++) {
			assert_int_equal(count_lit_within(spacings, 0.8, (gw_method)method, 0.0f), 0);
			if (spacings < 1.0)
				assert_int_equal(count_lit_within(spacings, 0.0, (gw_method)method, 0.0f), 0);
		}
}

/* As of furnaces in test_volume.c: rays that slip, and the pattern of a cell's; both bounces. */
#define GLOW_OFF (2.0 * (0.01 + 0.0035))

/* Two rooms that glow, a wall between them that is thinner than their points lie apart: by a grid
 * with cells of any size all points have cells on their side, with light. */
static void glowing_rooms_stay_light(void **state)
{
	(void)state;
	scene s = { 0 };
	box b = { .count = 6000, .width = 1.0, .facing = 1 };
	add_random_box(&s, b);
	size_t inside = s.count;
	add_random_box(&s, b);
	for (size_t i = inside; i < s.count; i++)
		s.position[3 * i] += 1.0 + 0.5 * sqrt(6.0 / 6000.0);
	scene_emit(&s, 0, (float[3]){ 1.0f, 1.0f, 1.0f });
	gw_points points = scene_points(&s);
	for (uint32_t cells = 2; cells < 200; cells *= 4) {
		gw_bake_options options = gw_bake_options_default();
		options.estimate_points = 0;
		options.method = GW_METHOD_VOLUME;
		options.volume_cells = cells;
		gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
		double sum = 0.0, least = 1e9;
		for (size_t i = 0; i < s.count; i++) {
			double e = (double)result->direct_irradiance[3 * i] +
					   (double)result->indirect_irradiance[3 * i];
			least = fmin(least, e / (2.0 * SCENE_PI));
			sum += e / (2.0 * SCENE_PI) / (double)s.count;
		}
		print_message("%u cells: %.4f of the light, at least %.4f\n", cells, sum, least);
		gw_bake_result_destroy(&result);
		assert_true(least > 1.0 - GLOW_OFF);
		assert_true(fabs(sum - 1.0) < GLOW_OFF);
	}
	scene_clear(&s);
}

/* Two rooms along the axes, of which the second one has the lamp, or walls that glow: floors and
 * ceilings go on from one into the other, through a wall thinner than their points lie apart. */
static void and_walls_between_rooms(void **state)
{
	(void)state;
	const double spacing = sqrt(6.0 / 6000.0);
	for (int i = 0; i < 4; i++) {
		box b = { .count = 6000, .width = 1.0, .facing = 1 };
		scene s = { .state = (uint64_t)i };
		add_random_box(&s, b);
		size_t inside = s.count;
		double off = 1.0 + 0.5 * (1 + i % 2) * spacing;
		add_random_box(&s, b);
		for (size_t k = inside; k < s.count; k++)
			s.position[3 * k] += off;
		const gw_light lamp = scene_point_light(off, 0.1, 0.2, 10.0f);
		if (i >= 2)
			scene_emit(&s, inside, glow);
		expect_no_glow_within(&s, inside, i < 2 ? &lamp : NULL);
		scene_clear(&s);
	}
}

/* A pillar of rock, hollow below, one of whose sides has fewer points. */
typedef struct pillar {
	double wide;
	double sparse; /* so many times as few */
	double off;    /* from the room's middle, the way that this side faces */
	double hole;   /* width of a square without points in the middle of it */
} pillar;

/* A room of 10,000 random points with a pillar in it. */
static void add_room_with_pillar(scene *s, pillar of)
{
	const double wide = of.wide, sparse = of.sparse, off = of.off;
	const double spacing = sqrt(6.0 / 10000.0), high = 0.6;
	scene room = { .state = s->state };
	add_random_box(&room, (box){ .count = 10000, .width = 1.0, .facing = 1 });
	s->state = room.state;
	for (size_t i = 0; i < room.count; i++) {
		const double *p = room.position + 3 * i;
		const double normal[3] = { (double)room.normal[3 * i], (double)room.normal[3 * i + 1],
								   (double)room.normal[3 * i + 2] };
		if (p[2] > -0.5 + 1e-9 || fmax(fabs(p[0] + off), fabs(p[1])) >= 0.5 * wide)
			scene_add(s, p, normal, 0.5f);
	}
	scene_clear(&room);
	for (int side = 0; side < 5; side++) {
		double area = wide * (side < 4 ? high : wide) / (spacing * spacing);
		size_t count = (size_t)(side == 0 ? area / sparse : area);
		for (size_t i = 0; i < count; i++) {
			double u = wide * (scene_random(s) - 0.5), v = scene_random(s);
			double place[3] = { u, wide * (v - 0.5), high - 0.5 }, normal[3] = { 0.0, 0.0, 1.0 };
			if (side < 4) {
				normal[side / 2] = side % 2 ? 1.0 : -1.0;
				place[side / 2] = 0.5 * wide * normal[side / 2];
				place[1 - side / 2] = u;
				place[2] = high * v - 0.5;
				normal[2] = 0.0;
			}
			double above = place[2] + 0.5 - 0.5 * high;
			if (side == 0 && fmax(fabs(place[1]), fabs(above)) < 0.5 * of.hole)
				continue;
			place[0] -= off;
			scene_add(s, place, normal, 0.5f);
		}
	}
}

/* Finds the compartments of a scene. */
static void find_compartments(const scene *s, gw_gpu **gpu, gw_surfels *surfels, gw_octree *octree)
{
	gw_error error;
	gw_points points = scene_points(s);
	const gw_surfels_options options = { .threads = 2, .normals = GW_NORMALS_GIVEN };
	assert_int_equal(gw_gpu_create(&(gw_gpu_options){ 0 }, gpu, &error), GW_OK);
	assert_int_equal(gw_surfels_make(&points, &options, surfels, &error), GW_OK);
	assert_int_equal(gw_octree_build(*gpu, surfels, GW_DEPTH_AUTO, octree, &error), GW_OK);
	assert_int_equal(gw_compartments_find(*gpu, surfels, 2, octree, &error), GW_OK);
}

/* Are a place in a room and what lies around it kept apart? */
static bool is_shut(const scene *s, const double place[3])
{
	gw_gpu *gpu = NULL;
	gw_surfels surfels = { 0 };
	gw_octree octree = { 0 };
	float g[3];
	find_compartments(s, &gpu, &surfels, &octree);
	for (int k = 0; k < 3; k++)
		g[k] = (float)(place[k] - surfels.origin[k] - (double)octree.cube_minimum[k]) /
			   octree.leaf_size;
	bool shut =
		gw_compartments_several(&octree) &&
		gw_compartments_apart(gw_compartment_at(&octree, g), gw_compartment_outside(&octree));
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&surfels);
	gw_gpu_destroy(&gpu);
	return shut;
}

/* How many surfels look out of a closed room, or nobody knows where? */
static size_t count_looking_out(const scene *s)
{
	gw_gpu *gpu = NULL;
	gw_surfels surfels = { 0 };
	gw_octree octree = { 0 };
	find_compartments(s, &gpu, &surfels, &octree);
	assert_true(gw_compartments_several(&octree));
	size_t out = 0;
	for (size_t i = 0; i < surfels.count; i++) {
		uint32_t label = gw_compartment_of_surfel(&octree, i, false);
		out += label == GW_COMPARTMENT_UNKNOWN || label == gw_compartment_outside(&octree);
	}
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&surfels);
	gw_gpu_destroy(&gpu);
	return out;
}

/* The side of a stalactite has a single point where its front has hundreds. A hole as wide as its
 * cells are joined the room and the pillar's inside, and so what lies around the room. */
static void holes_that_points_missed_are_shut(void **state)
{
	(void)state;
	const struct {
		uint64_t seed;
		double sparse;
	} rows[] = { { 5, 10.0 }, { 5, 20.0 }, { 8, 20.0 }, { 5, 40.0 }, { 6, 40.0 }, { 8, 40.0 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		scene s = { .state = rows[i].seed * 1000003u };
		add_room_with_pillar(&s, (pillar){ .wide = 0.12, .sparse = rows[i].sparse });
		bool shut = is_shut(&s, (const double[3]){ 0.4, 0.4, 0.3 });
		print_message("a side %.0f times as sparse: %s\n", rows[i].sparse, shut ? "shut" : "open");
		scene_clear(&s);
		assert_true(shut);
	}
}

/* Nor does surface look into rock through a hole of four spacings across a slit that is narrower
 * than cells. One surfel that did gave its compartment to all in the slit, most of which look
 * nowhere. */
static void nothing_looks_into_rock_across_slits(void **state)
{
	(void)state;
	const double spacing = sqrt(6.0 / 10000.0), wide = 0.2;
	size_t out = 0;
	for (uint64_t seed = 1; seed < 6; seed++) {
		for (int halves = 1; halves < 4; halves++) {
			scene s = { .state = seed * 1000003u };
			double off = 0.5 - 0.5 * wide - 0.5 * halves * spacing;
			add_room_with_pillar(&s, (pillar){ wide, 1.0, off, 4.0 * spacing });
			out += count_looking_out(&s);
			scene_clear(&s);
		}
	}
	print_message("in slits beside holes: %zu look out\n", out);
	assert_int_equal(out, 0);
}

static void expect_open(box b, double spacings)
{
	scene s = { 0 };
	b.window = spacings * sqrt(6.0 * fmax(b.dense, 1.0) / (double)b.count);
	add_random_box(&s, b);
	size_t lit = count_lit(&s, s.count);
	print_message("window of %.1f spacings: %zu of %zu lit\n", spacings, lit, s.count);
	assert_true(lit > s.count * 99 / 100);
	scene_clear(&s);
}

/* Windows of some spacings: sky through them lights all of the room. */
static void windows_stay_open(void **state)
{
	(void)state;
	box b = { .count = 10000, .width = 1.0, .facing = 1, .about_x = 0.4, .about_z = 0.9 };
	expect_open(b, 6.0);
	expect_open(b, 7.0);
	expect_open(b, 14.0);
	b.count = 30000; /* in surface of which one half is sparse */
	b.dense = 20.0;
	expect_open(b, 7.0);
}

/* A floor under a sheet of random points with a square hole in it, which the sun shines through. */
typedef struct holed_sheet {
	double spacing; /* of the points */
	double hole;    /* width */
	double turn;    /* of the hole and the sheet */
} holed_sheet;

#define SHEET 1.6
#define SHEET_HEIGHT 0.5
#define SUN_X 0.2
#define SUN_Y 0.1

/* Is a place of the sheet's plane in the hole, or less than a distance from it? */
static bool is_in_hole(holed_sheet h, double x, double y, double off)
{
	double u = cos(h.turn) * x + sin(h.turn) * y, v = cos(h.turn) * y - sin(h.turn) * x;
	return fmax(fabs(u), fabs(v)) < 0.5 * h.hole + off;
}

static void add_holed_sheet(scene *s, holed_sheet h)
{
	const double up[3] = { 0.0, 0.0, 1.0 }, down[3] = { 0.0, 0.0, -1.0 };
	size_t count = (size_t)(SHEET * SHEET / (h.spacing * h.spacing));
	for (size_t i = 0; i < 2 * count; i++) {
		double place[3] = { SHEET * (scene_random(s) - 0.5), SHEET * (scene_random(s) - 0.5),
							i < count ? 0.0 : SHEET_HEIGHT };
		if (i < count || !is_in_hole(h, place[0], place[1], 0.0))
			scene_add(s, place, i < count ? up : down, 0.5f);
	}
}

/* Points of the floor more than a spacing within the patch of sun, of which those that are dark. */
static size_t count_dark_within(holed_sheet h, size_t *within)
{
	scene s = { 0 };
	add_holed_sheet(&s, h);
	gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	options.bounces = 1;
	options.rays = 1;
	options.estimate_points = 0;
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .direction = { SUN_X, SUN_Y, -1.0 },
						   .irradiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_result *result = scene_bake(&points, &sun, 1, &options);
	size_t dark = 0;
	for (size_t i = 0; i < s.count && s.position[3 * i + 2] < 0.5 * SHEET_HEIGHT; i++) {
		double x = s.position[3 * i] - SUN_X * SHEET_HEIGHT;
		double y = s.position[3 * i + 1] - SUN_Y * SHEET_HEIGHT;
		if (!is_in_hole(h, x, y, -h.spacing))
			continue;
		++*within;
		dark += !(result->direct_irradiance[3 * i] > 0.0f);
	}
	gw_bake_result_destroy(&result);
	scene_clear(&s);
	return dark;
}

/* The rim of a hole is known to about a spacing, in corners to two. Single discs that stick out
 * over it, which most around do not, would keep half as much sun again from what lies further
 * within. */
static void holes_are_open_to_their_rims(void **state)
{
	(void)state;
	size_t dark = 0, within = 0;
	for (double turn = 0.0; turn < 1.0; turn += 0.4)
		dark += count_dark_within((holed_sheet){ 0.018, 0.18, turn }, &within);
	print_message("%zu of %zu points are dark in the sun through a hole\n", dark, within);
	assert_true(within > 150);
	assert_true(dark * 9 < within);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(closed_spheres_stay_dark),
		cmocka_unit_test(at_other_depths),
		cmocka_unit_test(closed_boxes_stay_dark),
		cmocka_unit_test(with_noisy_edges),
		cmocka_unit_test(unevenly_sampled_ones_as_well),
		cmocka_unit_test(sky_and_lamps_stay_outside),
		cmocka_unit_test(at_any_depth),
		cmocka_unit_test(cones_see_no_sky),
		cmocka_unit_test(what_glows_outside_stays_there),
		cmocka_unit_test(nor_through_walls_with_two_sides),
		cmocka_unit_test(nor_what_a_lamp_lights_next_door),
		cmocka_unit_test(white_rooms_keep_their_light),
		cmocka_unit_test(walls_with_two_sides_shut_out),
		cmocka_unit_test(so_do_walls_thinner_than_cells),
		cmocka_unit_test(so_do_those_that_only_show_their_glow),
		cmocka_unit_test(noise_changes_no_sides),
		cmocka_unit_test(cells_in_walls_belong_to_one_side),
		cmocka_unit_test(glowing_rooms_stay_light),
		cmocka_unit_test(and_walls_between_rooms),
		cmocka_unit_test(holes_that_points_missed_are_shut),
		cmocka_unit_test(nothing_looks_into_rock_across_slits),
		cmocka_unit_test(windows_stay_open),
		cmocka_unit_test(holes_are_open_to_their_rims),
	};
	/* One scene each for suns, cones, what glows, a lamp, a sky, and a hole that stays open. */
	const struct CMUnitTest by_shaders[] = {
		cmocka_unit_test(closed_spheres_stay_dark),
		cmocka_unit_test(cones_see_no_sky),
		cmocka_unit_test(nor_through_walls_with_two_sides),
		cmocka_unit_test(nor_what_a_lamp_lights_next_door),
		cmocka_unit_test(walls_with_two_sides_shut_out),
		cmocka_unit_test(holes_are_open_to_their_rims),
	};
	if (scene_by_shaders())
		return cmocka_run_group_tests(by_shaders, NULL, NULL);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
