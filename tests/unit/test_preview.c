/* The preview: exposure, tone map and encoding against their formulas. */
#include "options/preview.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* A dozen operations in double, each off by at most 2^-53 of values up to 100. */
#define ROUNDING 1e-12

static void assert_near(double a, double b, double tolerance)
{
	if (!(fabs(a - b) <= tolerance))
		fail_msg("%.17g is not %.17g", a, b);
}

static double map_grey(double value)
{
	double c[3] = { value, value, value };
	preview_tone_map(c);
	assert_near(c[1], c[0], ROUNDING);
	assert_near(c[2], c[0], ROUNDING);
	return c[0];
}

/* Rec.709: white has luminance 1, and the three weights belong to their channels. */
static void test_luminance(void **state)
{
	(void)state;
	const float white[3] = { 1, 1, 1 }, red[3] = { 1, 0, 0 }, blue[3] = { 0, 0, 1 };
	assert_near(preview_luminance(white), 1.0, ROUNDING);
	assert_near(preview_luminance(red), 0.2126, ROUNDING);
	assert_near(preview_luminance(blue), 0.0722, ROUNDING);
}

/* Luminances 1 and 4 have the geometric mean 2, which is 16 * 0.125, so the EV is 4. */
static void test_exposure_is_log_average(void **state)
{
	(void)state;
	const float radiance[6] = { 1, 1, 1, 4, 4, 4 };
	double exposure = preview_exposure(radiance, NULL, 2);
	assert_near(exposure, 4.0, ROUNDING);
	assert_near(2.0 * preview_scale(exposure), 0.18, ROUNDING);
}

/* Points without light, or with next to none, do not brighten the picture. */
static void test_exposure_ignores_darkness(void **state)
{
	(void)state;
	const float radiance[12] = { 2, 2, 2, 0, 0, 0, 1e-9f, 1e-9f, 1e-9f, 2, 2, 2 };
	const float dark[6] = { 0 };
	assert_near(preview_exposure(radiance, NULL, 4), 4.0, ROUNDING);
	assert_near(preview_exposure(dark, NULL, 2), 0.0, 0.0);
}

/* 90 dim points and 10 bright ones: mid grey of all would expose the bright ones at 1.2, so the
 * highlights decide: they come out at 1, or up to a bin of 1/32 doubling below. */
static void test_exposure_keeps_highlights(void **state)
{
	(void)state;
	float radiance[300];
	for (int i = 0; i < 300; i++)
		radiance[i] = i < 270 ? 1.0f : 8.0f;
	double lit = 8.0 * preview_scale(preview_exposure(radiance, NULL, 100));
	if (!(lit <= 1.0 + ROUNDING && lit >= exp2(-1.0 / 32.0)))
		fail_msg("exposed at %g", lit);
	/* One in fifty may be brighter than that: then the next ones decide. */
	for (int i = 270; i < 300; i++)
		radiance[i] = i < 294 ? 8.0f : 1000.0f;
	assert_near(8.0 * preview_scale(preview_exposure(radiance, NULL, 100)), lit, ROUNDING);
	for (int i = 270; i < 300; i++)
		radiance[i] = i < 291 ? 8.0f : 12.0f;
	double bright = 12.0 * preview_scale(preview_exposure(radiance, NULL, 100));
	if (!(bright <= 1.0 + ROUNDING))
		fail_msg("three in a hundred are exposed at %g", bright);
}

/* The same where highlights are 1,600 times as bright as all else: they darken the geometric mean
 * to half of mid grey, and are burnt. */
static void test_exposure_keeps_the_rest(void **state)
{
	(void)state;
	float radiance[300];
	for (int i = 0; i < 300; i++)
		radiance[i] = i < 270 ? 0.5f : 800.0f;
	double mean = pow(0.5, 0.9) * pow(800.0, 0.1);
	assert_near(mean * preview_scale(preview_exposure(radiance, NULL, 100)), 0.09, ROUNDING);
}

/* A lamp in the picture does not count, unless there is nothing else. */
static void test_exposure_ignores_emission(void **state)
{
	(void)state;
	const float radiance[9] = { 1, 1, 1, 4, 4, 4, 500, 500, 500 };
	const float lamp[9] = { 0, NAN, 0, 0, -1, 0, 500, 500, 500 };
	assert_near(preview_exposure(radiance, lamp, 3), 4.0, ROUNDING);
	assert_near(preview_exposure(radiance, radiance, 2), 4.0, ROUNDING);
}

/* Reinhard: luminance over one more than it; none: cut at 1. */
static void test_other_tones(void **state)
{
	(void)state;
	double c[3] = { 3.0, 3.0, 3.0 }, d[3] = { 3.0, 0.5, -1.0 };
	preview_tone_apply(PREVIEW_TONE_REINHARD, c);
	assert_near(c[1], 0.75, ROUNDING);
	preview_tone_apply(PREVIEW_TONE_NONE, d);
	assert_near(d[0], 1.0, 0.0);
	assert_near(d[1], 0.5, 0.0);
	assert_near(d[2], 0.0, 0.0);
}

/* The specification: up to 0.08 it is 6.25 x^2, from there to 0.8 it takes 0.04 off. */
static void test_tone_map_of_grey(void **state)
{
	(void)state;
	assert_near(map_grey(0.0), 0.0, ROUNDING);
	assert_near(map_grey(0.04), 6.25 * 0.04 * 0.04, ROUNDING);
	assert_near(map_grey(0.08), 0.04, ROUNDING);
	assert_near(map_grey(0.5), 0.46, ROUNDING);
	assert_near(map_grey(0.8 - 1e-9), 0.76, 2e-9);
	assert_near(map_grey(0.8 + 1e-9), 0.76, 2e-9);
}

/* Above 0.8 grey stays grey: 1 - 0.24^2 / (x - 0.04 + 0.24 - 0.76). */
static void test_tone_map_compresses(void **state)
{
	(void)state;
	assert_near(map_grey(2.0), 1.0 - 0.0576 / 1.44, ROUNDING);
	double before = -1.0;
	for (double x = 0.0; x < 100.0; x += 0.01) {
		double y = map_grey(x);
		if (!(y > before && y < 1.0))
			fail_msg("%g maps to %g after %g", x, y, before);
		before = y;
	}
}

/* Pure red, bright: the peak is that of grey less the offset, and some white is mixed in. */
static void test_tone_map_of_red(void **state)
{
	(void)state;
	double c[3] = { 10.0, 0.0, 0.0 };
	preview_tone_map(c);
	double peak = 1.0 - 0.0576 / (10.0 + 0.24 - 0.76);
	assert_near(c[0], peak, ROUNDING);
	assert_near(c[1], peak * (1.0 - 1.0 / (0.15 * (10.0 - peak) + 1.0)), ROUNDING);
	assert_near(c[2], c[1], ROUNDING);
}

/* Mid grey, 0.18, becomes 0.14 and then sRGB 0.4103 or 105 of 255 (104.6). */
static void test_color(void **state)
{
	(void)state;
	const float grey[3] = { 2, 2, 2 }, bad[3] = { -1, 0, 0 };
	const float bright[3] = { 3e38f, 3e38f, 3e38f };
	uint8_t rgb[3];
	preview_color(grey, preview_scale(4.0), rgb);
	assert_int_equal(rgb[0], 105);
	assert_int_equal(rgb[2], 105);
	preview_color(bright, 1.0, rgb);
	assert_int_equal(rgb[0], 255);
	preview_color(bad, 1.0, rgb);
	assert_int_equal(rgb[0], 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_luminance),
		cmocka_unit_test(test_exposure_is_log_average),
		cmocka_unit_test(test_exposure_ignores_darkness),
		cmocka_unit_test(test_exposure_keeps_highlights),
		cmocka_unit_test(test_exposure_keeps_the_rest),
		cmocka_unit_test(test_exposure_ignores_emission),
		cmocka_unit_test(test_other_tones),
		cmocka_unit_test(test_tone_map_of_grey),
		cmocka_unit_test(test_tone_map_compresses),
		cmocka_unit_test(test_tone_map_of_red),
		cmocka_unit_test(test_color),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
