#include "format.h"
#include "cloud_format.h"
#include "las_format.h"
#include "ply_format.h"

#include <string.h>
#include <strings.h>

/* In the order in which content is probed. */
const format *const formats[] = {
	&ply_format,
	&las_format,
	&laz_format,
	&cloud_format,
	NULL,
};

const format *format_by_name(const char *name)
{
	for (size_t f = 0; formats[f]; f++)
		if (strcasecmp(formats[f]->name, name) == 0)
			return formats[f];
	return NULL;
}

const format *format_by_path(const char *path)
{
	const char *slash = strrchr(path, '/');
	const char *dot = strrchr(slash ? slash : path, '.');
	if (!dot)
		return NULL;
	for (size_t f = 0; formats[f]; f++)
		for (const char *const *e = formats[f]->extensions; *e; e++)
			if (strcasecmp(dot + 1, *e) == 0)
				return formats[f];
	return NULL;
}

/* Names of all formats that can be read, for messages. */
static void list_readable(char *text, size_t size)
{
	text[0] = '\0';
	for (size_t f = 0; formats[f]; f++) {
		size_t used = strlen(text);
		if (!formats[f]->read || used + strlen(formats[f]->name) + 3 > size)
			continue;
		strcat(strcat(text, used ? ", " : ""), formats[f]->name);
	}
}

/* Content before extension: a wrong name is more common than a wrong first line. */
static const format *recognise(const char *path, const input_file *in)
{
	for (size_t f = 0; formats[f]; f++)
		if (formats[f]->read && formats[f]->probe && formats[f]->probe(in->data, in->length))
			return formats[f];
	const format *found = format_by_path(path);
	return found && found->read ? found : NULL;
}

gw_status format_read(const char *path, const char *name, scan *cloud, gw_error *error)
{
	const format *found;
	return format_read_found(path, name, cloud, &found, error);
}

gw_status format_read_found(const char *path, const char *name, scan *cloud,
							const format **recognised, gw_error *error)
{
	*cloud = (scan){ 0 };
	char known[256];
	list_readable(known, sizeof known);
	const format *found = name ? format_by_name(name) : NULL;
	if (name && (!found || !found->read))
		return gw_fail(error, GW_ERROR_USAGE, "'%s' is no format that can be read; there are %s",
					   name, known);
	input_file in;
	gw_status status = input_file_open(&in, path, error);
	if (status != GW_OK)
		return status;
	if (!found)
		found = recognise(path, &in);
	if (found)
		status = found->read(&in, cloud, error);
	else if (in.length == 0)
		status = gw_fail(error, GW_ERROR_DATA, "%s is empty", in.name);
	else
		status = gw_fail(error, GW_ERROR_DATA,
						 "%s is of no known format, by content or by name; there are %s", in.name,
						 known);
	input_file_close(&in);
	*recognised = found;
	return status;
}
