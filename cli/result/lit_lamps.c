#include "result/lit_lamps.h"
#include "files/growing_table.h"
#include "program/nearest_name.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char prefix[] = LIT_LAMPS_PREFIX;

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

static gw_status add_lamp(const scan *cloud, lit_lamps *lamps, const char *name, size_t length,
						  gw_error *error)
{
	lit_lamp added;
	for (size_t k = 0; k < 3; k++) {
		added.column[k] = find_channel(cloud, name, length, "rgb"[k]);
		if (added.column[k] == SIZE_MAX)
			return gw_fail(error, GW_ERROR_DATA,
						   "the lamp '%.*s' has no column %s%.*s_%c; all three channels are needed",
						   (int)length, name, prefix, (int)length, name, "rgb"[k]);
	}
	lit_lamp *grown = growing_table_room(lamps->lamp, lamps->count, sizeof *grown);
	if (grown)
		lamps->lamp = grown;
	added.name = strndup(name, length);
	if (!grown || !added.name) {
		free(added.name);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of lamps");
	}
	lamps->lamp[lamps->count++] = added;
	return GW_OK;
}

static bool is_known(const lit_lamps *lamps, const char *name, size_t length)
{
	for (size_t i = 0; i < lamps->count; i++)
		if (strlen(lamps->lamp[i].name) == length &&
			strncmp(lamps->lamp[i].name, name, length) == 0)
			return true;
	return false;
}

gw_status lit_lamps_find(const scan *cloud, lit_lamps *lamps, gw_error *error)
{
	size_t head = sizeof prefix - 1;
	*lamps = (lit_lamps){ .count = 0 };
	for (size_t c = 0; c < cloud->column_count; c++) {
		const char *own = cloud->column[c].name;
		size_t length = strlen(own);
		if (strncmp(own, prefix, head) != 0 || length < head + 3 || own[length - 2] != '_' ||
			!strchr("rgb", own[length - 1]) || is_known(lamps, own + head, length - head - 2))
			continue;
		GW_TRY(add_lamp(cloud, lamps, own + head, length - head - 2, error));
	}
	return GW_OK;
}

void lit_lamps_clear(lit_lamps *lamps)
{
	for (size_t i = 0; i < lamps->count; i++)
		free(lamps->lamp[i].name);
	free(lamps->lamp);
	*lamps = (lit_lamps){ .count = 0 };
}

size_t lit_lamp_group(const lit_lamp *of)
{
	size_t length = strcspn(of->name, ".");
	return of->name[length] ? length : 0;
}

bool lit_lamps_is_meant(const lit_lamps *lamps, size_t number, const settings_gain *gain)
{
	const lit_lamp *of = &lamps->lamp[number];
	size_t length = lit_lamp_group(of);
	if (strcmp(of->name, gain->name) == 0)
		return true;
	if (length == 0 || (!gain->group && is_known(lamps, gain->name, strlen(gain->name))))
		return false;
	return gain->group ? strlen(gain->name) == length && strncmp(of->name, gain->name, length) == 0
					   : strcmp(of->name + length + 1, gain->name) == 0;
}

/* Adds a name to a list of those that there are, unless it stands there. */
static void list_name(const char **names, size_t *count, const char *name, size_t length)
{
	for (size_t i = 0; i < *count; i++)
		if (strncmp(names[i], name, length) == 0 && strcspn(names[i], ".") == length)
			return;
	names[(*count)++] = name;
}

gw_status lit_lamps_fail_unknown(const lit_lamps *lamps, const settings_gain *gain, gw_error *error)
{
	char hint[NEAREST_NAME_HINT], known[512] = "";
	const char **names = calloc(lamps->count + 1, sizeof *names);
	const char *kind = gain->group ? "group" : "lamp";
	size_t count = 0;
	for (size_t i = 0; names && i < lamps->count; i++) {
		size_t length = lit_lamp_group(&lamps->lamp[i]);
		if (!gain->group)
			names[count++] = lamps->lamp[i].name;
		else if (length > 0)
			list_name(names, &count, lamps->lamp[i].name, length);
	}
	for (size_t i = 0; i < count; i++) {
		size_t used = strlen(known);
		int length = (int)(gain->group ? strcspn(names[i], ".") : strlen(names[i]));
		if (used + (size_t)length + 8 < sizeof known)
			snprintf(known + used, sizeof known - used, "%s%.*s", i ? ", " : "", length, names[i]);
		else if (used < 3 || strcmp(known + used - 3, "...") != 0)
			snprintf(known + used, sizeof known - used, "%s...", i ? " " : "");
	}
	nearest_name_hint(hint, gain->name, "", names, gain->group ? 0 : count);
	free(names);
	return gw_fail(error, GW_ERROR_USAGE, "the cloud has no %s '%.60s'; it has %s%s", kind,
				   gain->name, *known ? known : "none", hint);
}
