/* output_columns.c - see output_columns.h. */
#include "options/output_columns.h"

#include <stdio.h>
#include <string.h>

static bool has_room(const format *to, const char *name)
{
	if (!to->columns)
		return true;
	for (size_t i = 0; to->columns[i]; i++)
		if (strcmp(to->columns[i], name) == 0)
			return true;
	return false;
}

static bool is_light(const char *name)
{
	return strncmp(name, "scalar_radiance", 15) == 0;
}

void output_columns_note(const format *to, const scan *cloud, bool quiet)
{
	const char *example = NULL;
	size_t count = 0;
	for (size_t c = 0; c < cloud->column_count; c++) {
		const char *name = cloud->column[c].name;
		if (has_room(to, name))
			continue;
		if (!example || (is_light(name) && !is_light(example)))
			example = name;
		count++;
	}
	if (count > 0 && !quiet)
		fprintf(stderr,
				"glowworm: note: a .%s has room for places, normals and colours alone: %zu "
				"column%s left out, such as %s; a PLY has room for all\n",
				to->name, count, count == 1 ? " is" : "s are", example);
}
