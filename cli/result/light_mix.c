#include "result/light_mix.h"
#include "result/bake_columns.h"
#include "result/lit_lamps.h"
#include "options/preview.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lamps were added up before they were rounded to float32: of a hundred lamps, each rounded by
 * 2^-25 of itself, the sum is off by 2^-25 of the radiance at most, and the radiance is rounded
 * too. A thousand times as much cannot be rounding. */
#define LARGEST_DIFFERENCE 1e-4

/* And more than this many bits are not rounded away: --las-radiance bfloat16 does. */
#define ROUNDED_MOST 16

static const char prefix[] = LIT_LAMPS_PREFIX;

typedef struct work {
	light_mix *whole;
	scan *cloud;
	lit_lamps lamps;
	double (*factor)[3]; /* owned; lamps.count */
	gw_error *error;
} work;

/* ---------------------------------------------------------------------------------- lamps */

static gw_status find_lamps(work *m)
{
	GW_TRY(lit_lamps_find(m->cloud, &m->lamps, m->error));
	if (m->lamps.count == 0)
		return gw_fail(m->error, GW_ERROR_DATA,
					   "there are no lamps to mix: the points have no columns %sNAME_r, %sNAME_g, "
					   "%sNAME_b; bake with --fields lights",
					   prefix, prefix, prefix);
	m->factor = reallocarray(NULL, m->lamps.count, sizeof *m->factor);
	if (!m->factor)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for %zu lamps", m->lamps.count);
	for (size_t l = 0; l < m->lamps.count; l++)
		for (size_t k = 0; k < 3; k++)
			m->factor[l][k] = 1.0;
	return GW_OK;
}

static gw_status set_gains(work *m, const settings_gain *gain, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		bool found = false;
		for (size_t l = 0; l < m->lamps.count; l++) {
			if (!lit_lamps_is_meant(&m->lamps, l, &gain[i]))
				continue;
			found = true;
			for (size_t k = 0; k < 3; k++)
				m->factor[l][k] *= (double)gain[i].factor[k];
		}
		if (!found)
			return lit_lamps_fail_unknown(&m->lamps, &gain[i], m->error);
	}
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- sums */

static const scan_column *column_of(const work *m, size_t index, size_t channel)
{
	return &m->cloud->column[m->lamps.lamp[index].column[channel]];
}

static double note_bits(const work *m, double value)
{
	float single = (float)value;
	uint32_t bits;
	memcpy(&bits, &single, sizeof bits);
	m->whole->bits |= bits;
	return value;
}

/* How far rounding may have moved the sum, and the radiance itself, from what they were: each value
 * by half of its last bit at most, which is that share of it. */
static double largest_rounding(const light_mix *mix)
{
	uint32_t mantissa = mix->bits & ((1u << (FLT_MANT_DIG - 1)) - 1);
	int zeros = mantissa ? __builtin_ctz(mantissa) : ROUNDED_MOST;
	return 2.0 * ldexp(1.0, (zeros < ROUNDED_MOST ? zeros : ROUNDED_MOST) - FLT_MANT_DIG);
}

/* What the lamps as they came in add up to, beside the radiance that came in, if there is one. */
static void compare_sum(const work *m)
{
	for (size_t k = 0; k < 3; k++) {
		char name[] = "scalar_radiance_r";
		name[sizeof name - 2] = "rgb"[k];
		const scan_column *radiance = scan_find(m->cloud, name);
		for (size_t i = 0; radiance && i < m->cloud->count; i++) {
			double sum = 0.0, whole = note_bits(m, scan_value(radiance, i));
			for (size_t l = 0; l < m->lamps.count; l++)
				sum += note_bits(m, scan_value(column_of(m, l, k), i));
			m->whole->squares += (sum - whole) * (sum - whole);
			m->whole->own += whole * whole;
		}
	}
}

gw_status light_mix_check(const light_mix *mix, gw_error *error)
{
	double largest = LARGEST_DIFFERENCE + largest_rounding(mix);
	if (isfinite(mix->squares) && sqrt(mix->squares) <= largest * sqrt(mix->own))
		return GW_OK;
	return gw_fail(
		error, GW_ERROR_DATA,
		"the lamps do not add up to the radiance: they are off by %.3g %% of it, so some "
		"light is missing or not finite; bake again",
		100.0 * sqrt(mix->squares / mix->own));
}

/* Channel k of one lamp, stronger by its factor; adds it to the sum. */
static gw_status scale_lamp(const work *m, size_t l, size_t k, double *sum)
{
	scan_column *column = &m->cloud->column[m->lamps.lamp[l].column[k]];
	size_t count = m->cloud->count;
	float *data = reallocarray(NULL, count + 1, sizeof *data);
	if (!data)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for the column '%s'", column->name);
	for (size_t i = 0; i < count; i++) {
		double value = scan_value(column, i) * m->factor[l][k];
		data[i] = (float)value;
		sum[i] += value;
	}
	free(column->data);
	column->data = data;
	column->type = SCAN_FLOAT32;
	return GW_OK;
}

/* Scales channel k of all lamps and adds them up. */
static gw_status sum_channel(const work *m, size_t k, float *radiance)
{
	gw_status status = GW_OK;
	double *sum = calloc(m->cloud->count + 1, sizeof *sum);
	if (!sum)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for the sum of %zu lamps",
					   m->lamps.count);
	for (size_t l = 0; l < m->lamps.count && status == GW_OK; l++)
		status = scale_lamp(m, l, k, sum);
	for (size_t i = 0; i < m->cloud->count && status == GW_OK; i++) {
		radiance[3 * i + k] = (float)sum[i];
		if (!isfinite(radiance[3 * i + k]))
			status =
				gw_fail(m->error, GW_ERROR_DATA, "the sum of the lamps is not finite at place %llu",
						(unsigned long long)(m->whole->points + i));
	}
	free(sum);
	return status;
}

static gw_status put_floats(const work *m, const char *name, const float *values, size_t stride)
{
	scan_column *column = scan_find(m->cloud, name);
	if (column && column->type != SCAN_FLOAT32) {
		scan_remove_column(m->cloud, name);
		column = NULL;
	}
	if (!column)
		column = scan_add_column(m->cloud, name, SCAN_FLOAT32, m->error);
	if (!column)
		return GW_ERROR_MEMORY;
	for (size_t i = 0; i < m->cloud->count; i++)
		((float *)column->data)[i] = values[stride * i];
	return GW_OK;
}

static gw_status put_radiance(const work *m, const float *radiance)
{
	float *luminance = reallocarray(NULL, m->cloud->count + 1, sizeof *luminance);
	if (!luminance)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for the luminance");
	for (size_t i = 0; i < m->cloud->count; i++)
		luminance[i] = (float)preview_luminance(radiance + 3 * i);
	gw_status status = put_floats(m, "quality", luminance, 1);
	free(luminance);
	for (size_t k = 0; k < 3 && status == GW_OK; k++) {
		char name[] = "scalar_radiance_r";
		name[sizeof name - 2] = "rgb"[k];
		status = put_floats(m, name, radiance + k, 3);
	}
	return status;
}

static gw_status apply(work *m, float *radiance)
{
	GW_TRY(find_lamps(m));
	GW_TRY(set_gains(m, m->whole->gain, m->whole->gain_count));
	if (!m->whole->adds_up)
		compare_sum(m);
	if (!isfinite(m->whole->squares))
		return light_mix_check(m->whole, m->error);
	for (size_t k = 0; k < 3; k++)
		GW_TRY(sum_channel(m, k, radiance));
	return put_radiance(m, radiance);
}

gw_status light_mix_apply(light_mix *whole, scan *cloud, float **radiance, gw_error *error)
{
	work m = { .whole = whole, .cloud = cloud, .error = error };
	whole->removed = bake_columns_remove(cloud, BAKE_COLUMNS_OF_LIGHT);
	*radiance = calloc(cloud->count ? cloud->count : 1, 3 * sizeof **radiance);
	gw_status status =
		*radiance ? apply(&m, *radiance)
				  : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", cloud->count);
	free(m.factor);
	lit_lamps_clear(&m.lamps);
	if (status != GW_OK) {
		free(*radiance);
		*radiance = NULL;
	}
	whole->points += cloud->count;
	return status;
}
