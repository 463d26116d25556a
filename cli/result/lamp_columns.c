#include "result/lamp_columns.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char prefix[] = "scalar_light_";

/* Room for the name of one lamp's columns, without scalar_light_ and channel. */
#define LAMP_COLUMN_NAME 72

static bool is_taken(const char *name, char (*names)[LAMP_COLUMN_NAME], size_t count)
{
	bool taken = strcmp(name, "rest") == 0;
	for (size_t i = 0; i < count; i++)
		taken = taken || strcmp(name, names[i]) == 0;
	return taken;
}

static void clean(const gw_light *light, char name[64])
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
	const char *type =
		light->type == GW_LIGHT_ENVIRONMENT ? "sky" : gw_light_type_name(light->type);
	snprintf(name, 64, "%s", light->name[0] ? light->name : type);
	for (char *c = name; *c; c++)
		*c = strchr(plain, *c) ? *c : '_';
}

/*
 * The names of the lamps of a scene: as given, in letters that every program takes (others become
 * _); a lamp without a name is called by its type; a name that is taken, or "rest", gets a number.
 *   name   receives s->light_count of them
 */
static void name_lamps(const settings *s, char (*name)[LAMP_COLUMN_NAME])
{
	for (size_t i = 0; i < s->light_count; i++) {
		char own[64];
		clean(&s->light[i].light, own);
		snprintf(name[i], LAMP_COLUMN_NAME, "%s", own);
		for (unsigned n = 2; is_taken(name[i], name, i); n++)
			snprintf(name[i], LAMP_COLUMN_NAME, "%.60s_%u", own, n);
	}
}

static gw_status add_lamp(scan *lit, const char *name, const float *radiance, gw_error *error)
{
	for (size_t k = 0; k < 3; k++) {
		char full[sizeof prefix + LAMP_COLUMN_NAME + 2];
		snprintf(full, sizeof full, "%s%s_%c", prefix, name, "rgb"[k]);
		scan_column *column = scan_add_column(lit, full, SCAN_FLOAT32, error);
		if (!column)
			return GW_ERROR_MEMORY;
		for (size_t i = 0; i < lit->count; i++)
			((float *)column->data)[i] = radiance[3 * i + k];
	}
	return GW_OK;
}

gw_status lamp_columns_add(scan *lit, const gw_bake_result *result, const settings *s,
						   gw_error *error)
{
	char(*name)[LAMP_COLUMN_NAME] = calloc(s->light_count + 1, sizeof *name);
	if (!name)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the names of %zu lamps",
					   s->light_count);
	name_lamps(s, name);
	gw_status status = GW_OK;
	for (size_t i = 0; i < result->lamp_count && status == GW_OK; i++)
		status = add_lamp(lit, name[i], result->lamp[i], error);
	if (status == GW_OK && result->rest)
		status = add_lamp(lit, "rest", result->rest, error);
	free(name);
	return status;
}

void lamp_columns_remove(scan *cloud)
{
	for (size_t c = cloud->column_count; c-- > 0;)
		if (strncmp(cloud->column[c].name, prefix, strlen(prefix)) == 0)
			scan_remove_column(cloud, cloud->column[c].name);
}
