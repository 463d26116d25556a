#include "result/bake_columns.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef enum column_kind {
	OTHER,
	LIGHT, /* is wrong once lamps are dimmed */
	MIXED, /* is light, too, but made again then */
} column_kind;

typedef struct column_group {
	const char *name;
	const char *channel; /* letters behind the name and a _, or NULL: one column */
	column_kind kind;
} column_group;

static const column_group groups[] = {
	{ "quality", NULL, MIXED },
	{ "scalar_radiance", "rgb", MIXED },
	{ "scalar_direct", "rgb", LIGHT },
	{ "scalar_indirect", "rgb", LIGHT },
	{ "scalar_irradiance", "rgb", LIGHT },
	{ "scalar_direct_irradiance", "rgb", LIGHT },
	{ "scalar_indirect_irradiance", "rgb", LIGHT },
	{ "scalar_luminance", NULL, LIGHT },
	{ "scalar_illuminance", NULL, LIGHT },
	{ "scalar_error", NULL, LIGHT },
	{ "scalar_roi", NULL, OTHER },
	{ "scalar_ao", NULL, OTHER },
	{ "scalar_bent_normal", "xyz", OTHER },
	{ "scalar_unknown", NULL, OTHER },
	{ "scalar_normal", "xyz", OTHER },
};

size_t bake_columns_remove(scan *cloud, bake_columns which)
{
	size_t before = cloud->column_count;
	for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
		const column_group *g = &groups[i];
		if (which == BAKE_COLUMNS_OF_LIGHT && g->kind != LIGHT)
			continue;
		if (!g->channel)
			scan_remove_column(cloud, g->name);
		for (const char *c = g->channel; c && *c; c++) {
			char name[64];
			snprintf(name, sizeof name, "%s_%c", g->name, *c);
			scan_remove_column(cloud, name);
		}
	}
	return before - cloud->column_count;
}

/* Is a column one of a group? Their names begin alike. */
static bool is_of(const column_group *g, const char *name)
{
	size_t length = strlen(g->name);
	if (strncmp(name, g->name, length) != 0)
		return false;
	if (!g->channel)
		return !name[length];
	return name[length] == '_' && name[length + 1] && strchr(g->channel, name[length + 1]) &&
		   !name[length + 2];
}

bool bake_columns_is_light(const char *name)
{
	static const char of_lamp[] = "scalar_light_";
	if (strncmp(name, of_lamp, sizeof of_lamp - 1) == 0)
		return true;
	for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
		if (groups[i].kind != OTHER && is_of(&groups[i], name))
			return true;
	return false;
}

/* To the nearer of two values of so many bits, to the even one of two that are as near. What is no
 * number stays none. */
static float round_to_bits(float value, int kept)
{
	const int dropped = FLT_MANT_DIG - kept;
	uint32_t bits, half = 1u << (dropped - 1), exponent = 0x7f800000;
	memcpy(&bits, &value, sizeof bits);
	if ((bits & exponent) == exponent)
		return value;
	uint32_t rounded = bits + half - 1 + (bits >> dropped & 1);
	/* The largest ones would become infinite. */
	bits = ((rounded & exponent) == exponent ? bits : rounded) & ~(2 * half - 1);
	memcpy(&value, &bits, sizeof value);
	return value;
}

/* No unit normal becomes zero. What is no number stays none. */
static float round_normal(float value, int unused)
{
	(void)unused;
	return (float)(rint((double)value / BAKE_COLUMNS_NORMAL_STEP) * BAKE_COLUMNS_NORMAL_STEP);
}

static bool is_normal(const char *name)
{
	static const column_group own = { .name = "scalar_normal", .channel = "xyz" };
	bool given = name[0] == 'n' && name[1] && strchr("xyz", name[1]) && !name[2];
	return given || is_of(&own, name);
}

static void round_columns(scan *cloud, bool (*which)(const char *name),
						  float (*round)(float value, int kept), int kept)
{
	for (size_t c = 0; c < cloud->column_count; c++) {
		const scan_column *column = &cloud->column[c];
		if (column->type != SCAN_FLOAT32 || !which(column->name))
			continue;
		float *value = column->data;
		for (size_t i = 0; i < cloud->count; i++)
			value[i] = round(value[i], kept);
	}
}

/* The decimal number that somebody wrote, which a float is only near to. */
static double decimal_of(float value)
{
	double scale = pow(10.0, 6.0 - ceil(log10((double)value)));
	return rint((double)value * scale) / scale;
}

void bake_columns_round(scan *cloud, const settings *s)
{
	static const int kept[SETTINGS_LAS_COUNT] = {
		[SETTINGS_LAS_HALF] = 11,
		[SETTINGS_LAS_BFLOAT16] = 8,
	};
	if (kept[s->las_radiance])
		round_columns(cloud, bake_columns_is_light, round_to_bits, kept[s->las_radiance]);
	if (s->las_step <= 0.0f)
		return;
	round_columns(cloud, is_normal, round_normal, 0);
	cloud->step = decimal_of(s->las_step);
}

bool bake_columns_photometric(const scan *cloud)
{
	for (size_t c = 0; c < cloud->comment_count; c++)
		if (strncmp(cloud->comment[c], "glowworm units:", 15) == 0 &&
			strstr(cloud->comment[c], "cd/m^2"))
			return true;
	return false;
}
