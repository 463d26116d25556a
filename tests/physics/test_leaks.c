/*
 * test_leaks.c - the sun outside of closed rock: no point within sees it.
 *
 * Spheres and boxes of points at random places, seen from within. Whatever light arrives is a leak,
 * so what is expected is zero, without a tolerance; but for boxes that lie askew, in whose creases
 * random points leave cells without any of the wall.
 */
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

/* A unit cube, each side of points at random places, turned about x and then about z by angles. */
static void add_random_box(scene *s, size_t count, double about_x, double about_z)
{
	const double turn[3][3] = {
		{ cos(about_z), -sin(about_z) * cos(about_x), sin(about_z) * sin(about_x) },
		{ sin(about_z), cos(about_z) * cos(about_x), -cos(about_z) * sin(about_x) },
		{ 0.0, sin(about_x), cos(about_x) },
	};
	for (size_t i = 0; i < count; i++) {
		size_t axis = i % 3;
		double side = i % 6 < 3 ? -1.0 : 1.0, flat[3], place[3], normal[3];
		for (int k = 0; k < 3; k++)
			flat[k] = scene_random(s) - 0.5;
		flat[axis] = 0.5 * side;
		for (int k = 0; k < 3; k++) {
			normal[k] = -side * turn[k][axis];
			place[k] = turn[k][0] * flat[0] + turn[k][1] * flat[1] + turn[k][2] * flat[2];
		}
		scene_add(s, place, normal, 0.5f);
	}
}

/* Points that a sun from some height, degrees, reaches, of six around. */
static size_t count_lit(const scene *s, double height, uint32_t depth)
{
	gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	options.bounces = 1;
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
	for (size_t i = 0; i < s->count; i++)
		lit += result->direct_irradiance[3 * i] > 0.0f;
	gw_bake_result_destroy(&result);
	return lit;
}

static void expect_dark(size_t count, double noise, double height, uint32_t depth)
{
	scene s = { 0 };
	add_random_sphere(&s, count, noise);
	size_t lit = count_lit(&s, height, depth);
	print_message("%zu points, noise %.2f, sun at %.0f degrees, depth %u: %zu lit\n", count, noise,
				  height, depth, lit);
	scene_clear(&s);
	assert_int_equal(lit, 0);
}

static void closed_spheres_stay_dark(void **state)
{
	(void)state;
	expect_dark(3000, 0.0, 40.0, GW_DEPTH_AUTO);
	expect_dark(3000, 0.0, 5.0, GW_DEPTH_AUTO);
	expect_dark(3000, 0.5, 70.0, GW_DEPTH_AUTO);
	expect_dark(20000, 0.0, 20.0, GW_DEPTH_AUTO);
}

static void at_other_depths(void **state)
{
	(void)state;
	expect_dark(3000, 0.0, 40.0, 4);
	expect_dark(3000, 0.0, 40.0, 6);
}

static size_t count_lit_in_box(size_t count, double about_x, double about_z, double height)
{
	scene s = { 0 };
	add_random_box(&s, count, about_x, about_z);
	size_t lit = count_lit(&s, height, GW_DEPTH_AUTO);
	print_message("%zu points, box turned by %.1f and %.1f, sun at %.0f degrees: %zu lit\n", count,
				  about_x, about_z, height, lit);
	scene_clear(&s);
	return lit;
}

/* Rays pass where two walls meet, and where a corner has no point near. */
static void closed_boxes_stay_dark(void **state)
{
	(void)state;
	for (int height = 10; height < 90; height += 25)
		assert_int_equal(count_lit_in_box(10000, 0.0, 0.0, height), 0);
}

/* Of 240,000 pairs of points and suns. */
static void boxes_askew_are_nearly_dark(void **state)
{
	(void)state;
	size_t lit = 0;
	for (int height = 10; height < 90; height += 25)
		lit += count_lit_in_box(10000, 0.8, 0.5, height);
	assert_true(lit <= 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(closed_spheres_stay_dark),
		cmocka_unit_test(at_other_depths),
		cmocka_unit_test(closed_boxes_stay_dark),
		cmocka_unit_test(boxes_askew_are_nearly_dark),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
