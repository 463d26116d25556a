/* Scenes in other units: what has a length in it goes along. */
#include "bake/scaled_scene.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static gw_status make(float area, double reach, gw_scaled_scene *scaled, gw_error *error)
{
	static double position[12];
	static float own_area[4];
	static gw_points points;
	for (size_t i = 0; i < 12; i++)
		position[i] = reach * (double)(i % 5);
	own_area[1] = area;
	points = (gw_points){ .count = 4, .position = position, .own_area = own_area };
	const gw_bake_options options = gw_bake_options_default();
	const gw_scene_description scene = { .points = &points };
	return gw_scaled_scene_make(&scene, &options, 0.0, scaled, error);
}

/* What a wire covers in a cloud of 1e-12 m is an area like any other. */
static void areas_are_scaled(void **state)
{
	(void)state;
	gw_error error;
	gw_scaled_scene scaled;
	assert_ok(make(1e-26f, 1e-12, &scaled, &error), &error);
	assert_true(scaled.length > 0);
	assert_non_null(scaled.points.own_area);
	assert_float_equal(scaled.points.own_area[0], 0.0f, 0.0f);
	assert_true(scaled.points.own_area[1] == ldexpf(1e-26f, 2 * scaled.length));
	gw_scaled_scene_clear(&scaled);
}

static void ordinary_scenes_stay(void **state)
{
	(void)state;
	gw_error error;
	gw_scaled_scene scaled;
	assert_ok(make(0.01f, 1.0, &scaled, &error), &error);
	assert_int_equal(scaled.length, 0);
	assert_float_equal(scaled.points.own_area[1], 0.01f, 0.0f);
	gw_scaled_scene_clear(&scaled);
}

/* A lamp of 1 W/sr is infinite where lengths are 2^100 times as long; what a light does not use is
 * nobody's business. */
static void lights_fit(void **state)
{
	(void)state;
	gw_error error;
	gw_light *own = NULL;
	const gw_scaled_scene scaled = { .length = 100 };
	const gw_light lamp = { .type = GW_LIGHT_POINT, .intensity = { 1.0f, 1.0f, 1.0f } };
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .intensity = { INFINITY, 0.0f, 0.0f },
						   .irradiance = { 1.0f, 1.0f, 1.0f } };
	assert_int_equal(gw_scaled_lights(&scaled, &lamp, 1, &own, &error), GW_ERROR_DATA);
	assert_null(own);
	assert_ok(gw_scaled_lights(&scaled, &sun, 1, &own, &error), &error);
	assert_true(own->irradiance[0] == 1.0f);
	free(own);
}

/* A lamp that is 2^500 times as far off as a cloud of 2^-500 m is wide lights it as a lamp does:
 * its light on the cloud and its angle stay, to the rounding of a float32. */
static void far_lamps_fit(void **state)
{
	(void)state;
	gw_error error;
	gw_light *own = NULL;
	const gw_scaled_scene scaled = {
		.length = 500, .light = 3, .middle = { 0x1p-498, 0, 0 }, .extent = -500
	};
	const gw_light lamp = { .type = GW_LIGHT_SPHERE,
							.position = { 3.0, -4.0, 0.0 },
							.radius = 0.5f,
							.intensity = { 50.0f, 0.0f, 1e-30f } };
	assert_ok(gw_scaled_lights(&scaled, &lamp, 1, &own, &error), &error);
	const double to[3] = { own->position[0] - 4.0, own->position[1], own->position[2] };
	double distance = hypot(to[0], to[1]);
	assert_true(distance > 0x1p20 && distance < 0x1p27);
	assert_true(fabs(to[0] / distance - 0.6) < 1e-7 && fabs(to[1] / distance + 0.8) < 1e-7);
	assert_true(fabs((double)own->intensity[0] / (distance * distance) / 16.0 - 1.0) < 1e-6);
	assert_true((double)own->intensity[2] > 0.0);
	assert_true(fabs((double)own->radius / distance - 0.1) < 1e-7);
	free(own);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(areas_are_scaled),
		cmocka_unit_test(ordinary_scenes_stay),
		cmocka_unit_test(lights_fit),
		cmocka_unit_test(far_lamps_fit),
	};
	return cmocka_run_group_tests_name("scaled_scene", tests, NULL, NULL);
}
