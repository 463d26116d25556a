/* The environment's map: against a uniform sky, a sun, closed forms, and itself turned. */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define W 256
#define H 128

static float pixels[3 * W * H];

static gw_light map_light(void)
{
	return (gw_light){ .type = GW_LIGHT_ENVIRONMENT,
					   .radiance = { 1, 1, 1 },
					   .map = pixels,
					   .map_width = W,
					   .map_height = H };
}

static void fill(float r, float g, float b)
{
	for (size_t i = 0; i < W * H; i++)
		memcpy(pixels + 3 * i, (float[3]){ r, g, b }, 3 * sizeof(float));
}

/* A horizontal floor, 1.2 m, and a wall of 0.6 m that stands in its middle along x. */
static void make_floor(scene *s, bool wall)
{
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0, 0, 0 }, (double[3]){ 1.25, 0, 0 },
									(double[3]){ 0, 1.25, 0 }, 50, 50 },
					0.5f);
	if (!wall)
		return;
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0, 0.625, 0 }, (double[3]){ 1.25, 0, 0 },
									(double[3]){ 0, 0, 0.5 }, 50, 20 },
					0.5f);
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0, 0.65625, 0.5 }, (double[3]){ 1.25, 0, 0 },
									(double[3]){ 0, 0, -0.5 }, 50, 20 },
					0.5f);
}

static gw_bake_result *bake(const scene *s, const gw_light *light, gw_method method)
{
	gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	options.method = method;
	options.bounces = 1;
	options.rays = 256;
	options.light_samples = 256;
	options.estimate_points = 0;
	return scene_bake(&points, light, 1, &options);
}

/* Mean of one channel of the direct irradiance of the points within a range of y. */
static double mean_at(const scene *s, const gw_bake_result *r, double low, double high, int channel)
{
	double sum = 0.0;
	size_t count = 0;
	for (size_t i = 0; i < s->count; i++) {
		const double *p = s->position + 3 * i;
		if (p[2] > 0.0 || p[1] < low || p[1] > high || p[0] < 0.25 || p[0] > 1.0)
			continue;
		sum += (double)r->direct_irradiance[3 * i + (size_t)channel];
		count++;
	}
	assert_true(count > 20);
	return sum / (double)count;
}

static const gw_method methods[] = { GW_METHOD_RAYS, GW_METHOD_CONES };

/* A map that is the same everywhere is the uniform sky, on the floor with its wall too. The rays
 * of the one and the rays and samples of the other err by at most 1 / sqrt(256) a record of what
 * varies, the cosine-weighted visibility, which is under a half: 3 %; the mean is over more than 20
 * records: 0.7 %, times 4.5. With cones the map is sampled, too. */
static void constant_map_is_uniform_sky(void **state)
{
	(void)state;
	scene s = { 0 };
	make_floor(&s, true);
	fill(0.5f, 1.0f, 2.0f);
	gw_light uniform = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 0.5f, 1.0f, 2.0f } };
	gw_light map = map_light();
	gw_bake_result *expected = bake(&s, &uniform, GW_METHOD_RAYS);
	for (size_t m = 0; m < 2; m++) {
		gw_bake_result *found = bake(&s, &map, methods[m]);
		for (int c = 0; c < 3; c++) {
			double low = mean_at(&s, expected, 0.3, 0.55, c), is = mean_at(&s, found, 0.3, 0.55, c);
			if (!(fabs(is - low) <= 0.03 * low))
				fail_msg("%s, channel %d: %g under the map, %g under the sky",
						 gw_method_name(methods[m]), c, is, low);
		}
		gw_bake_result_destroy(&found);
	}
	gw_bake_result_destroy(&expected);
	scene_clear(&s);
}

/* Lights the pixels of the map within an angle of a direction; returns the irradiance on a plane
 * that faces it, and the power on the horizontal floor. */
static void put_disc(double azimuth, double elevation, double radius, float radiance,
					 double *horizontal)
{
	double axis[3] = { sin(azimuth) * cos(elevation), cos(azimuth) * cos(elevation),
					   sin(elevation) };
	*horizontal = 0.0;
	for (size_t y = 0; y < H; y++) {
		for (size_t x = 0; x < W; x++) {
			double t0 = SCENE_PI * (double)y / H, t1 = SCENE_PI * (double)(y + 1) / H;
			double t = 0.5 * (t0 + t1);
			double a = 2.0 * SCENE_PI * (((double)x + 0.5) / W - 0.5);
			double d[3] = { sin(a) * sin(t), cos(a) * sin(t), cos(t) };
			if (d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2] < cos(radius))
				continue;
			for (size_t c = 0; c < 3; c++)
				pixels[3 * (y * W + x) + c] = radiance;
			/* The integral of cosine over the pixel. */
			*horizontal +=
				(double)radiance * (2.0 * SCENE_PI / W) * (0.25 * (cos(2.0 * t0) - cos(2.0 * t1)));
		}
	}
}

/* A small bright disc is a sun: the irradiance of the open floor is that of its pixels, and where
 * the wall stands between there is none. All 256 samples of a record fall on the disc, 8 degrees
 * wide, over which the cosine varies by 6 %: 6 % / sqrt(256) a record, less in the mean: 1 %. */
static void bright_disc_is_a_sun(void **state)
{
	(void)state;
	scene s = { 0 };
	make_floor(&s, true);
	for (int south = 0; south < 2; south++) {
		double azimuth = south ? SCENE_PI : 0.0, elevation = SCENE_PI / 4, horizontal;
		fill(0, 0, 0);
		put_disc(azimuth, elevation, 4.0 * SCENE_PI / 180.0, 1000.0f, &horizontal);
		gw_light map = map_light();
		gw_light sun = { .type = GW_LIGHT_SUN,
						 .direction = { 0, south ? 1 : -1, -1 },
						 .angle = 8.0f };
		for (int c = 0; c < 3; c++)
			sun.irradiance[c] = (float)(horizontal / sin(elevation));
		gw_bake_result *as_sun = bake(&s, &sun, GW_METHOD_RAYS);
		for (size_t m = 0; m < 2; m++) {
			gw_bake_result *r = bake(&s, &map, methods[m]);
			/* The wall is 0.5 m high and its shadow 0.5 m long, but for 8 degrees. */
			double lit = south ? mean_at(&s, r, 0.1, 0.5, 0) : mean_at(&s, r, 0.8, 1.15, 0);
			double dark = south ? mean_at(&s, r, 0.75, 1.0, 0) : mean_at(&s, r, 0.3, 0.55, 0);
			double by_sun =
				south ? mean_at(&s, as_sun, 0.1, 0.5, 0) : mean_at(&s, as_sun, 0.8, 1.15, 0);
			if (!(fabs(lit / horizontal - 1.0) <= 0.01) || !(fabs(lit / by_sun - 1.0) <= 0.01))
				fail_msg("lit: %g, by the sun %g, expected %g", lit, by_sun, horizontal);
			if (!(dark <= 0.01 * horizontal))
				fail_msg("in the shadow of the wall: %g of %g", dark, horizontal);
			gw_bake_result_destroy(&r);
		}
		gw_bake_result_destroy(&as_sun);
	}
	scene_clear(&s);
}

/* Turned by 180 degrees the light from north is light from south; with y up the same holds in a
 * scene that is turned to y up. */
static void turned_map_turns_the_light(void **state)
{
	(void)state;
	scene s = { 0 };
	make_floor(&s, true);
	double horizontal;
	fill(0, 0, 0);
	put_disc(-SCENE_PI / 2, SCENE_PI / 4, 0.07, 1000.0f, &horizontal);
	gw_light map = map_light();
	for (int step = 0; step < 4; step++) {
		/* From west, turned clockwise by 90 degrees: from north; then from east, from south. */
		map.rotation = 90.0f * (float)step;
		gw_bake_result *r = bake(&s, &map, GW_METHOD_RAYS);
		double south = mean_at(&s, r, 0.3, 0.55, 1), north = mean_at(&s, r, 0.75, 1.0, 1);
		/* 1 % as above; along the wall both sides are lit. */
		assert_true(fabs(south / horizontal - (step != 1)) <= 0.01);
		assert_true(fabs(north / horizontal - (step != 3)) <= 0.01);
		gw_bake_result_destroy(&r);
	}
	for (size_t i = 0; i < s.count; i++) {
		double *p = s.position + 3 * i, y = p[1];
		float *n = s.normal + 3 * i, ny = n[1];
		p[1] = p[2], p[2] = -y;
		n[1] = n[2], n[2] = -ny;
	}
	map.rotation = 90.0f;
	map.map_y_up = true;
	gw_bake_result *r = bake(&s, &map, GW_METHOD_RAYS);
	double sum[2] = { 0, 0 };
	size_t count[2] = { 0, 0 };
	for (size_t i = 0; i < s.count; i++) {
		double north = -s.position[3 * i + 2], x = s.position[3 * i];
		int side = north > 0.75 && north < 1.0 ? 1 : north > 0.3 && north < 0.55 ? 0 : -1;
		if (side < 0 || s.position[3 * i + 1] > 0.0 || x < 0.25 || x > 1.0)
			continue;
		sum[side] += (double)r->direct_irradiance[3 * i];
		count[side]++;
	}
	assert_true(fabs(sum[0] / (double)count[0] / horizontal) <= 0.01);
	assert_true(fabs(sum[1] / (double)count[1] / horizontal - 1.0) <= 0.01);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* White furnace: an open floor that sees the upper half of a constant map has E = pi L. The map
 * has a sun-like bright pixel of the same total luminance below the horizon, which it cannot see
 * and on which half the samples are lost. */
static void open_floor_has_a_closed_form(void **state)
{
	(void)state;
	scene s = { 0 };
	make_floor(&s, false);
	fill(1, 1, 1);
	pixels[3 * (W * (H - 20) + 7) + 1] = 20000.0f;
	gw_light map = map_light();
	gw_bake_result *r = bake(&s, &map, GW_METHOD_RAYS);
	double is = mean_at(&s, r, 0.25, 1.0, 1);
	/* Rays and samples together err by under 1 / sqrt(256) of it a record, over more than 100
	 * records: 0.6 %, times 4.5. */
	assert_true(fabs(is / SCENE_PI - 1.0) <= 0.028);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

static uint64_t counted(const gw_report *report, const char *name)
{
	for (uint32_t i = 0; i < report->count_count; i++)
		if (strcmp(report->count[i].name, name) == 0)
			return report->count[i].points;
	return 0;
}

/* Pixels that no sky has are counted, and nothing else comes of them than is promised. */
static void odd_pixels_are_counted(void **state)
{
	(void)state;
	scene s = { 0 };
	make_floor(&s, false);
	fill(1, 1, 1);
	pixels[5] = NAN;
	pixels[6] = -1.0f;
	pixels[7] = -INFINITY;
	pixels[3 * W * (H - 1)] = INFINITY;
	pixels[3 * W * (H - 1) + 1] = 1e30f;
	gw_light map = map_light();
	gw_bake_result *r = bake(&s, &map, GW_METHOD_RAYS);
	assert_int_equal(counted(&r->report, "map_pixels_repaired"), 3);
	assert_int_equal(counted(&r->report, "map_pixels_infinite"), 2);
	for (size_t i = 0; i < 3 * s.count; i++)
		assert_true(isfinite(r->radiance[i]) && r->radiance[i] >= 0.0f);
	gw_bake_result_destroy(&r);
	/* One without light is night. */
	fill(0, 0, 0);
	r = bake(&s, &map, GW_METHOD_RAYS);
	for (size_t i = 0; i < 3 * s.count; i++)
		assert_true(r->radiance[i] == 0.0f);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* A map too large for the device's texels is averaged: the light stays. */
static void large_maps_are_averaged(void **state)
{
	(void)state;
	enum { BIG_W = 3000, BIG_H = 1500 };
	float *big = malloc(3 * sizeof *big * BIG_W * BIG_H);
	assert_non_null(big);
	for (size_t i = 0; i < (size_t)BIG_W * BIG_H; i++)
		for (size_t c = 0; c < 3; c++)
			big[3 * i + c] = i % BIG_W % 2 ? 0.0f : 2.0f;
	scene s = { 0 };
	make_floor(&s, false);
	gw_light map = map_light();
	map.map = big;
	map.map_width = BIG_W;
	map.map_height = BIG_H;
	gw_bake_result *r = bake(&s, &map, GW_METHOD_RAYS);
	/* As in the furnace; texels of 1.46 pixels differ by half, and share the error of the rays. */
	assert_true(fabs(mean_at(&s, r, 0.25, 1.0, 1) / SCENE_PI - 1.0) <= 0.028);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
	free(big);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(constant_map_is_uniform_sky),
		cmocka_unit_test(bright_disc_is_a_sun),
		cmocka_unit_test(turned_map_turns_the_light),
		cmocka_unit_test(open_floor_has_a_closed_form),
		cmocka_unit_test(odd_pixels_are_counted),
		cmocka_unit_test(large_maps_are_averaged),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
