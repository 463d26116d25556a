#include "result/lamp_columns.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char prefix[] = "scalar_light_";

/* Room for the name of one lamp's columns, without scalar_light_ and channel: group.name. */
#define LAMP_COLUMN_NAME 136

/* A lamp's columns, or a group's. */
typedef struct lamp_name {
	char own[72];   /* of the lamp */
	char group[64]; /* "" for none */
	char column[LAMP_COLUMN_NAME];
} lamp_name;

/* Whether a name is that of another lamp, or of a group. */
static bool is_taken(const char *name, const lamp_name *names, size_t count, size_t all)
{
	bool taken = strcmp(name, "rest") == 0;
	for (size_t i = 0; i < count; i++)
		taken = taken || strcmp(name, names[i].own) == 0;
	for (size_t i = 0; i < all; i++)
		taken = taken || strcmp(name, names[i].group) == 0;
	return taken;
}

/* In letters that every program takes; others become _. */
static void clean(const char *from, char name[64])
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
	snprintf(name, 64, "%s", from);
	for (char *c = name; *c; c++)
		*c = strchr(plain, *c) ? *c : '_';
}

static const char *given_name(const gw_light *light)
{
	if (light->name[0])
		return light->name;
	return light->type == GW_LIGHT_ENVIRONMENT ? "sky" : gw_light_type_name(light->type);
}

/*
 * The names of the lamps of a scene: as given; a lamp without a name is called by its type; a name
 * that is taken, or "rest", gets a number. The group stands before it, with a dot, which no name
 * has.
 *   name   receives s->light_count of them
 */
static void name_lamps(const settings *s, lamp_name *name)
{
	size_t all = s->light_count;
	for (size_t i = 0; i < all; i++)
		clean(s->light[i].group, name[i].group);
	for (size_t i = 0; i < all; i++) {
		lamp_name *n = &name[i];
		char own[64];
		clean(given_name(&s->light[i].light), own);
		snprintf(n->own, sizeof n->own, "%s", own);
		for (unsigned k = 2; is_taken(n->own, name, i, all); k++)
			snprintf(n->own, sizeof n->own, "%.60s_%u", own, k);
		snprintf(n->column, sizeof n->column, "%s%s%s", n->group, n->group[0] ? "." : "", n->own);
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

/* All lamps of the group of lamp `first` in one column. */
static gw_status add_group(scan *lit, const gw_bake_result *result, const lamp_name *name,
						   size_t first, gw_error *error)
{
	size_t values = 3 * lit->count;
	double *sum = calloc(values + 1, sizeof *sum);
	float *radiance = calloc(values + 1, sizeof *radiance);
	gw_status status = GW_ERROR_MEMORY;
	for (size_t l = first; sum && l < result->lamp_count; l++)
		for (size_t i = 0; i < values && strcmp(name[l].group, name[first].group) == 0; i++)
			sum[i] += (double)result->lamp[l][i];
	for (size_t i = 0; sum && radiance && i < values; i++)
		radiance[i] = (float)sum[i];
	if (sum && radiance)
		status = add_lamp(lit, name[first].group, radiance, error);
	else
		gw_fail(error, GW_ERROR_MEMORY, "no memory for the sum of a group of lamps");
	free(sum);
	free(radiance);
	return status;
}

/* Whether a lamp's group has its column already. */
static bool is_added(const lamp_name *name, size_t which)
{
	bool added = false;
	for (size_t i = 0; i < which; i++)
		added = added || strcmp(name[i].group, name[which].group) == 0;
	return added;
}

static gw_status add_all(scan *lit, const gw_bake_result *result, const settings *s,
						 const lamp_name *name, gw_error *error)
{
	bool each = s->fields & 1u << SETTINGS_FIELD_LIGHTS;
	for (size_t i = 0; i < result->lamp_count; i++) {
		if (each || !name[i].group[0])
			GW_TRY(add_lamp(lit, name[i].column, result->lamp[i], error));
		else if (!is_added(name, i))
			GW_TRY(add_group(lit, result, name, i, error));
	}
	if (result->rest)
		GW_TRY(add_lamp(lit, "rest", result->rest, error));
	return GW_OK;
}

gw_status lamp_columns_add(scan *lit, const gw_bake_result *result, const settings *s,
						   gw_error *error)
{
	lamp_name *name = calloc(s->light_count + 1, sizeof *name);
	if (!name)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the names of %zu lamps",
					   s->light_count);
	name_lamps(s, name);
	gw_status status = add_all(lit, result, s, name, error);
	free(name);
	return status;
}

void lamp_columns_remove(scan *cloud)
{
	for (size_t c = cloud->column_count; c-- > 0;)
		if (strncmp(cloud->column[c].name, prefix, strlen(prefix)) == 0)
			scan_remove_column(cloud, cloud->column[c].name);
}
