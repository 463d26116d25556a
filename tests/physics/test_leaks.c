/*
 * test_leaks.c - the sun outside of closed rock: no point within sees it.
 *
 * Spheres of points at random places, seen from within. Whatever light arrives is a leak, so what
 * is expected is zero, without a tolerance.
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(closed_spheres_stay_dark),
		cmocka_unit_test(at_other_depths),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
