/*
 * test_shadow_map.c - shadow maps against geometry: the shadow of a square on a plane.
 *
 * A square of 1 m hangs 1 m above a plane. The share of the light that each point of the plane gets
 * is its irradiance over the unshadowed one in closed form. It has to be 1 outside of the shadow
 * that a straight edge throws, about 0 inside, and the whole shadow as large as the projection.
 */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SPACING 0.04
#define PLANE_SIDE 101 /* points; the plane reaches 2 m from the middle */
#define SQUARE_SIDE 25 /* cells of 4 cm make it 1 m wide */
#define PLANE_POINTS (PLANE_SIDE * PLANE_SIDE)
#define POINTS (PLANE_POINTS + SQUARE_SIDE * SQUARE_SIDE)

/* Both maps give exactly 1 where nothing comes before the receiver, so what is left is the rounding
 * of positions (float, in leaf cells) and of the irradiance. */
#define LIT_TOLERANCE 1e-4

/* In the core the variance map is the smaller or equal one to its bound v / (v + d^2), with a least
 * variance v of 0.01 leaf cells^2 and d the distance in front, here above 10 leaf cells: 1e-4. */
#define DARK_TOLERANCE 1e-3

typedef struct clouds {
	double position[3 * POINTS];
	float normal[3 * POINTS];
	float albedo[3 * POINTS];
} clouds;

typedef struct shadow_case {
	gw_light light;
	uint32_t size;
	double middle, half; /* of the shadow on the plane: its centre in x, half its side */
	double texel;        /* width of a texel on the plane, roughly */
	bool facing_down;    /* the square's normal */
} shadow_case;

static void add_grid(clouds *s, size_t first, int side, double z, float normal_z)
{
	for (int i = 0; i < side * side; i++) {
		size_t p = first + (size_t)i;
		s->position[3 * p] = SPACING * (i % side - (side - 1) / 2);
		s->position[3 * p + 1] = SPACING * (i / side - (side - 1) / 2);
		s->position[3 * p + 2] = z;
		s->normal[3 * p + 2] = normal_z;
	}
}

static gw_bake_result *bake(const shadow_case *test)
{
	clouds *s = calloc(1, sizeof *s);
	assert_non_null(s);
	add_grid(s, 0, PLANE_SIDE, 0.0, 1.0f);
	add_grid(s, PLANE_POINTS, SQUARE_SIDE, 1.0, test->facing_down ? -1.0f : 1.0f);
	gw_points points = {
		.count = POINTS, .position = s->position, .normal = s->normal, .albedo = s->albedo
	};
	gw_bake_options options = gw_bake_options_default();
	options.shadows = GW_SHADOWS_MAPS;
	options.shadow_map_size = test->size;
	options.bounces = 1;
	options.validate = GW_VALIDATE_CALLS;
	scene_choose_passes(&options.passes, &options.validate);
	gw_bake_result *result = NULL;
	gw_error error = { 0 };
	if (gw_bake(&(gw_scene_description){ &points, &test->light, 1 }, &options, NULL, &result,
				&error) != GW_OK)
		fail_msg("%s", error.text);
	free(s);
	return result;
}

/* What a point of the plane gets without the square. */
static double unshadowed(const gw_light *light, double x, double y)
{
	if (light->type == GW_LIGHT_SUN) {
		const double *d = light->direction;
		return (double)light->irradiance[0] * -d[2] / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	}
	double h = light->position[2], squared = x * x + y * y + h * h;
	return (double)light->intensity[0] * h / (squared * sqrt(squared));
}

static void check(const shadow_case *test)
{
	gw_bake_result *r = bake(test);
	double dark = 0.0, shadow = 0.0;
	/* The edge of the square is known to a leaf cell, and the filter is 5 texels wide. */
	double magnified = fmin(test->half / 0.5, 2.0);
	double margin = magnified * 1.5 * r->report.leaf_size + 3.5 * test->texel;
	size_t inside = 0, outside = 0;
	for (int i = 0; i < PLANE_POINTS; i++) {
		double x = SPACING * (i % PLANE_SIDE - PLANE_SIDE / 2);
		double y = SPACING * (i / PLANE_SIDE - PLANE_SIDE / 2);
		double seen = (double)r->direct_irradiance[3 * i] / unshadowed(&test->light, x, y);
		double beyond = fmax(fabs(x - test->middle), fabs(y)) - test->half;
		if (beyond < -margin) {
			dark = fmax(dark, seen);
			inside++;
		} else if (beyond > margin) {
			if (fabs(seen - 1.0) > LIT_TOLERANCE)
				fail_msg("%g of the light at %g, %g: outside of the shadow", seen, x, y);
			outside++;
		}
		shadow += (1.0 - seen) * SPACING * SPACING;
	}
	gw_bake_result_destroy(&r);
	print_message("   dark %g, shadow %g m^2, margin %g m\n", dark, shadow, margin);
	assert_true(inside > 100);
	assert_true(dark < DARK_TOLERANCE);
	if (test->half < 2.0) {
		assert_true(outside > 100);
		/* The planes in the leaves reach up to a leaf cell beyond the square, so that its outline
		 * moves by half of that on average; half the margin is 3/4 of it. */
		double area = 4.0 * test->half * test->half;
		assert_true(fabs(shadow - area) < 8.0 * test->half * 0.5 * margin);
	}
}

static const gw_light point = { .type = GW_LIGHT_POINT,
								.position = { 0.0, 0.0, 3.0 },
								.intensity = { 10.0f, 10.0f, 10.0f } };

/* Wide enough for the plane's corners, 43.3 degrees from the axis. */
static const gw_light spot = { .type = GW_LIGHT_SPOT,
							   .position = { 0.0, 0.0, 3.0 },
							   .direction = { 0.0, 0.0, -2.0 },
							   .intensity = { 10.0f, 10.0f, 10.0f },
							   .inner_angle = 50.0f,
							   .outer_angle = 60.0f };

/* The square is seen 0.3 m aside; on the plane it is as large as itself. */
static const gw_light sun = { .type = GW_LIGHT_SUN,
							  .direction = { 0.3, 0.0, -1.0 },
							  .irradiance = { 5.0f, 5.0f, 5.0f } };

static void test_point(void **state)
{
	(void)state;
	check(&(shadow_case){ .light = point, .size = 1024, .half = 0.75, .texel = 6.0 / 1024 });
}

static void test_spot(void **state)
{
	(void)state;
	check(&(shadow_case){ .light = spot, .size = 512, .half = 0.75, .texel = 10.4 / 512 });
}

/* Two windows a side, whose border crosses the shadow. */
static void test_windows(void **state)
{
	(void)state;
	check(&(shadow_case){ .light = spot, .size = 4096, .half = 0.75, .texel = 10.4 / 4096 });
}

/* A cone that is too wide for one map. */
static void test_wide_spot(void **state)
{
	(void)state;
	shadow_case test = { .light = spot, .size = 700, .half = 0.75, .texel = 6.0 / 700 };
	test.light.outer_angle = 120.0f;
	check(&test);
}

static void test_sun(void **state)
{
	(void)state;
	shadow_case test = {
		.light = sun, .size = 512, .middle = 0.3, .half = 0.5, .texel = 5.0 / 512
	};
	check(&test);
	/* Scanned from below only, it throws the same shadow. */
	test.facing_down = true;
	check(&test);
}

/* A lamp 6 cm above the square: a leaf's picture covers many tiles, and a hole in it would let
 * light through. The whole plane is dark. */
static void test_near_lamp(void **state)
{
	(void)state;
	shadow_case test = { .light = point, .size = 1024, .half = 8.8, .texel = 2.1 / 1024 };
	test.light.position[2] = 1.06;
	check(&test);
}

/* A lamp far outside has one map over the cloud, not a few texels of a cube's face. */
static void test_far_lamp(void **state)
{
	(void)state;
	double half = 0.5 * 30.0 / 29.0;
	shadow_case test = { .light = point, .size = 256, .half = half, .texel = 6.0 / 256 };
	test.light.position[2] = 30.0;
	check(&test);
}

static void test_same_bytes(void **state)
{
	(void)state;
	shadow_case test = { .light = point, .size = 256 };
	test.light.position[0] = 0.31;
	gw_bake_result *a = bake(&test), *b = bake(&test);
	assert_memory_equal(a->direct_irradiance, b->direct_irradiance, 3 * POINTS * sizeof(float));
	gw_bake_result_destroy(&a);
	gw_bake_result_destroy(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_point),    cmocka_unit_test(test_spot),
		cmocka_unit_test(test_windows),  cmocka_unit_test(test_wide_spot),
		cmocka_unit_test(test_sun),      cmocka_unit_test(test_near_lamp),
		cmocka_unit_test(test_far_lamp), cmocka_unit_test(test_same_bytes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
