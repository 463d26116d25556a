/* Lamps mixed in a cloud made by hand: sums, gains, what is stale, what is refused. */
#include "result/light_mix.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The sum of doubles is rounded once to float32. */
#define HALF_ULP 0x1p-24

enum { COUNT = 50 };

static float *add(scan *cloud, const char *name)
{
	gw_error error = { 0 };
	scan_column *column = scan_add_column(cloud, name, SCAN_FLOAT32, &error);
	assert_non_null(column);
	return column->data;
}

static double lamp_value(size_t lamp_index, size_t channel, size_t i)
{
	return (double)(float)(0.1 + 0.37 * (double)lamp_index + 0.011 * (double)i +
						   0.3 * (double)channel);
}

/* Lamps called a_b, r and rest, and the radiance that they make; a column between them. */
static scan make_cloud(void)
{
	static const char *const name[] = { "a_b", "r", "rest" };
	scan cloud = { .count = COUNT, .up = 'z' };
	for (size_t k = 0; k < 3; k++) {
		char full[64] = "scalar_radiance_r";
		full[16] = "rgb"[k];
		float *radiance = add(&cloud, full);
		for (size_t i = 0; i < COUNT; i++)
			for (size_t l = 0; l < 3; l++)
				radiance[i] += (float)lamp_value(l, k, i);
	}
	for (size_t l = 0; l < 3; l++) {
		for (size_t k = 0; k < 3; k++) {
			char full[64];
			snprintf(full, sizeof full, "scalar_light_%s_%c", name[l], "rgb"[k]);
			float *data = add(&cloud, full);
			for (size_t i = 0; i < COUNT; i++)
				data[i] = (float)lamp_value(l, k, i);
		}
	}
	add(&cloud, "scalar_direct_g");
	add(&cloud, "infrared");
	return cloud;
}

static double read(const scan *cloud, const char *name, size_t i)
{
	const scan_column *column = scan_find(cloud, name);
	assert_non_null(column);
	return scan_value(column, i);
}

static void assert_near(double found, double expected, double tolerance)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%.9g is not %.9g", found, expected);
}

/* The mix of a cloud that is one part. */
static gw_status mix_all(scan *cloud, const settings_gain *gain, size_t gain_count,
						 float **radiance, gw_error *error)
{
	light_mix mix = { .gain = gain, .gain_count = gain_count };
	gw_status status = light_mix_apply(&mix, cloud, radiance, error);
	return status == GW_OK ? light_mix_check(&mix, error) : status;
}

static void lamps_add_up(void **state)
{
	(void)state;
	scan cloud = make_cloud();
	const settings_gain gain[] = { { "a_b", { 2, 0, 1 }, false, NULL },
								   { "r", { 3, 3, 3 }, false, NULL },
								   { "r", { 0.5f, 0.5f, 0.5f }, false, NULL } };
	const double factor[3][3] = { { 2, 0, 1 }, { 1.5, 1.5, 1.5 }, { 1, 1, 1 } };
	float *radiance;
	gw_error error = { 0 };
	light_mix mix = { .gain = gain, .gain_count = 3 };
	if (light_mix_apply(&mix, &cloud, &radiance, &error) != GW_OK ||
		light_mix_check(&mix, &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_int_equal(mix.removed, 1);
	assert_null(scan_find(&cloud, "scalar_direct_g"));
	assert_non_null(scan_find(&cloud, "infrared"));
	for (size_t i = 0; i < COUNT; i++) {
		double sum[3] = { 0 };
		for (size_t k = 0; k < 3; k++) {
			char name[] = "scalar_radiance_r";
			name[16] = "rgb"[k];
			for (size_t l = 0; l < 3; l++)
				sum[k] += factor[l][k] * lamp_value(l, k, i);
			assert_near(read(&cloud, name, i), sum[k], HALF_ULP * sum[k]);
			assert_true((double)radiance[3 * i + k] == read(&cloud, name, i));
		}
		double luminance = 0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2];
		assert_near(read(&cloud, "quality", i), luminance, 2 * HALF_ULP * luminance);
		assert_true(read(&cloud, "scalar_light_a_b_g", i) == 0.0);
		assert_near(read(&cloud, "scalar_light_r_b", i), 1.5 * lamp_value(1, 2, i), HALF_ULP * 4);
	}
	free(radiance);
	scan_clear(&cloud);
}

/* Twice as strong, then half as strong: as it was, to the bit (factors of two do not round). */
static void mixes_can_be_undone(void **state)
{
	(void)state;
	scan cloud = make_cloud();
	float *first, *second, *third;
	const settings_gain same = { "r", { 1, 1, 1 }, false, NULL },
						twice = { "r", { 2, 2, 2 }, false, NULL },
						half = { "r", { 0.5f, 0.5f, 0.5f }, false, NULL };
	assert_int_equal(mix_all(&cloud, &same, 1, &first, NULL), GW_OK);
	assert_int_equal(mix_all(&cloud, &twice, 1, &second, NULL), GW_OK);
	assert_int_equal(mix_all(&cloud, &half, 1, &third, NULL), GW_OK);
	assert_memory_equal(first, third, 3 * COUNT * sizeof *first);
	assert_true(second[0] > first[0]);
	free(first);
	free(second);
	free(third);
	scan_clear(&cloud);
}

static void assert_refused(scan *cloud, const char *name, gw_status status, const char *part)
{
	const settings_gain gain = { name, { 1, 1, 1 }, false, NULL };
	float *radiance;
	gw_error error = { 0 };
	assert_int_equal(mix_all(cloud, &gain, 1, &radiance, &error), status);
	free(radiance);
	if (!strstr(error.text, part))
		fail_msg("'%s' does not say '%s'", error.text, part);
	scan_clear(cloud);
}

static void what_is_not_whole_is_refused(void **state)
{
	(void)state;
	scan cloud = make_cloud();
	assert_refused(&cloud, "a_c", GW_ERROR_USAGE, "a_b, r, rest; did you mean 'a_b'?");
	cloud = make_cloud();
	scan_remove_column(&cloud, "scalar_light_r_g");
	assert_refused(&cloud, "r", GW_ERROR_DATA, "scalar_light_r_g");
	cloud = make_cloud();
	for (size_t k = 0; k < 3; k++) {
		char name[] = "scalar_light_rest_r";
		name[18] = "rgb"[k];
		scan_remove_column(&cloud, name);
	}
	assert_refused(&cloud, "r", GW_ERROR_DATA, "do not add up");
	cloud = make_cloud();
	((float *)scan_find(&cloud, "scalar_light_r_r")->data)[7] = NAN;
	assert_refused(&cloud, "r", GW_ERROR_DATA, "not finite");
	cloud = (scan){ .count = 3 };
	add(&cloud, "scalar_light_r");
	assert_refused(&cloud, "r", GW_ERROR_DATA, "no lamps");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lamps_add_up),
		cmocka_unit_test(mixes_can_be_undone),
		cmocka_unit_test(what_is_not_whole_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
