#include "result/light_mix.h"
#include "result/bake_columns.h"
#include "files/growing_table.h"
#include "program/nearest_name.h"
#include "options/preview.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lamps were added up before they were rounded to float32: of a hundred lamps, each rounded by
 * 2^-25 of itself, the sum is off by 2^-25 of the radiance at most, and the radiance is rounded
 * too. A thousand times as much cannot be rounding. */
#define LARGEST_DIFFERENCE 1e-4

static const char prefix[] = "scalar_light_";

/* One lamp of a cloud: its columns by their places, because columns move when others go. */
typedef struct mix_lamp {
	char *name; /* owned */
	size_t column[3];
	double factor[3];
} mix_lamp;

typedef struct work {
	light_mix *whole;
	scan *cloud;
	mix_lamp *lamp; /* owned; count */
	size_t count;
	gw_error *error;
} work;

/* ---------------------------------------------------------------------------------- lamps */

/* Place of the column scalar_light_NAME_CHANNEL, or SIZE_MAX. */
static size_t find_channel(const scan *cloud, const char *name, size_t length, char channel)
{
	size_t head = sizeof prefix - 1;
	for (size_t c = 0; c < cloud->column_count; c++) {
		const char *own = cloud->column[c].name;
		if (strlen(own) == head + length + 2 && strncmp(own, prefix, head) == 0 &&
			strncmp(own + head, name, length) == 0 && own[head + length] == '_' &&
			own[head + length + 1] == channel)
			return c;
	}
	return SIZE_MAX;
}

static gw_status add_lamp(work *m, const char *name, size_t length)
{
	mix_lamp added = { .factor = { 1.0, 1.0, 1.0 } };
	for (size_t k = 0; k < 3; k++) {
		added.column[k] = find_channel(m->cloud, name, length, "rgb"[k]);
		if (added.column[k] == SIZE_MAX)
			return gw_fail(m->error, GW_ERROR_DATA,
						   "the lamp '%.*s' has no column %s%.*s_%c; all three channels are needed",
						   (int)length, name, prefix, (int)length, name, "rgb"[k]);
	}
	mix_lamp *grown = growing_table_room(m->lamp, m->count, sizeof *grown);
	if (grown)
		m->lamp = grown;
	added.name = strndup(name, length);
	if (!grown || !added.name) {
		free(added.name);
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for the list of lamps");
	}
	m->lamp[m->count++] = added;
	return GW_OK;
}

static bool is_known(const work *m, const char *name, size_t length)
{
	for (size_t i = 0; i < m->count; i++)
		if (strlen(m->lamp[i].name) == length && strncmp(m->lamp[i].name, name, length) == 0)
			return true;
	return false;
}

static gw_status find_lamps(work *m)
{
	size_t head = sizeof prefix - 1;
	for (size_t c = 0; c < m->cloud->column_count; c++) {
		const char *own = m->cloud->column[c].name;
		size_t length = strlen(own);
		if (strncmp(own, prefix, head) != 0 || length < head + 3 || own[length - 2] != '_' ||
			!strchr("rgb", own[length - 1]) || is_known(m, own + head, length - head - 2))
			continue;
		GW_TRY(add_lamp(m, own + head, length - head - 2));
	}
	if (m->count == 0)
		return gw_fail(m->error, GW_ERROR_DATA,
					   "there are no lamps to mix: the points have no columns %sNAME_r, %sNAME_g, "
					   "%sNAME_b",
					   prefix, prefix, prefix);
	return GW_OK;
}

/* Adds a name to a list of those that there are, unless it stands there. */
static void list_name(const char **names, size_t *count, const char *name, size_t length)
{
	for (size_t i = 0; i < *count; i++)
		if (strncmp(names[i], name, length) == 0 && strcspn(names[i], ".") == length)
			return;
	names[(*count)++] = name;
}

static gw_status fail_unknown(const work *m, const settings_gain *gain)
{
	char hint[NEAREST_NAME_HINT], known[512] = "";
	const char **names = calloc(m->count + 1, sizeof *names);
	const char *kind = gain->group ? "group" : "lamp";
	size_t count = 0;
	for (size_t i = 0; names && i < m->count; i++) {
		size_t length = strcspn(m->lamp[i].name, ".");
		if (!gain->group)
			names[count++] = m->lamp[i].name;
		else if (m->lamp[i].name[length])
			list_name(names, &count, m->lamp[i].name, length);
	}
	for (size_t i = 0; i < count; i++) {
		size_t used = strlen(known);
		int length = (int)(gain->group ? strcspn(names[i], ".") : strlen(names[i]));
		if (used + (size_t)length + 8 < sizeof known)
			snprintf(known + used, sizeof known - used, "%s%.*s", i ? ", " : "", length, names[i]);
		else if (strcmp(known + used - 4, " ...") != 0)
			snprintf(known + used, sizeof known - used, " ...");
	}
	nearest_name_hint(hint, gain->name, "", names, gain->group ? 0 : count);
	free(names);
	return gw_fail(m->error, GW_ERROR_USAGE, "the cloud has no %s '%.60s'; it has %s%s", kind,
				   gain->name, *known ? known : "none", hint);
}

/* Whether a lamp, GROUP.NAME or NAME, is meant; a group may stand in one column of its name. */
static bool is_meant(const mix_lamp *of, const settings_gain *gain)
{
	size_t length = strcspn(of->name, ".");
	if (strcmp(of->name, gain->name) == 0)
		return true;
	if (!of->name[length])
		return false;
	return gain->group ? strlen(gain->name) == length && strncmp(of->name, gain->name, length) == 0
					   : strcmp(of->name + length + 1, gain->name) == 0;
}

static gw_status set_gains(work *m, const settings_gain *gain, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		bool found = false;
		for (size_t l = 0; l < m->count; l++) {
			if (!is_meant(&m->lamp[l], &gain[i]))
				continue;
			found = true;
			for (size_t k = 0; k < 3; k++)
				m->lamp[l].factor[k] *= (double)gain[i].factor[k];
		}
		if (!found)
			return fail_unknown(m, &gain[i]);
	}
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- sums */

static const scan_column *column_of(const work *m, size_t index, size_t channel)
{
	return &m->cloud->column[m->lamp[index].column[channel]];
}

/* What the lamps as they came in add up to, beside the radiance that came in, if there is one. */
static void compare_sum(const work *m)
{
	for (size_t k = 0; k < 3; k++) {
		char name[] = "scalar_radiance_r";
		name[sizeof name - 2] = "rgb"[k];
		const scan_column *radiance = scan_find(m->cloud, name);
		for (size_t i = 0; radiance && i < m->cloud->count; i++) {
			double sum = 0.0, whole = scan_value(radiance, i);
			for (size_t l = 0; l < m->count; l++)
				sum += scan_value(column_of(m, l, k), i);
			m->whole->squares += (sum - whole) * (sum - whole);
			m->whole->own += whole * whole;
		}
	}
}

gw_status light_mix_check(const light_mix *mix, gw_error *error)
{
	if (isfinite(mix->squares) && sqrt(mix->squares) <= LARGEST_DIFFERENCE * sqrt(mix->own))
		return GW_OK;
	return gw_fail(
		error, GW_ERROR_DATA,
		"the lamps do not add up to the radiance: they are off by %.3g %% of it, so some "
		"light is missing or not finite; bake again",
		100.0 * sqrt(mix->squares / mix->own));
}

/* Channel k of one lamp, stronger by its factor; adds it to the sum. */
static gw_status scale_lamp(const work *m, const mix_lamp *scaled, size_t k, double *sum)
{
	scan_column *column = &m->cloud->column[scaled->column[k]];
	size_t count = m->cloud->count;
	float *data = reallocarray(NULL, count + 1, sizeof *data);
	if (!data)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for the column '%s'", column->name);
	for (size_t i = 0; i < count; i++) {
		double value = scan_value(column, i) * scaled->factor[k];
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
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for the sum of %zu lamps", m->count);
	for (size_t l = 0; l < m->count && status == GW_OK; l++)
		status = scale_lamp(m, &m->lamp[l], k, sum);
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
	for (size_t i = 0; i < m.count; i++)
		free(m.lamp[i].name);
	free(m.lamp);
	if (status != GW_OK) {
		free(*radiance);
		*radiance = NULL;
	}
	whole->points += cloud->count;
	return status;
}
