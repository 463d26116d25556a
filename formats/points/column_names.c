#include "points/column_names.h"

#include <stddef.h>
#include <strings.h>

typedef struct alias {
	const char *theirs, *ours;
} alias;

/* The name that a list ending in NULL has for `name`, or NULL. */
static const char *find(const alias *list, const char *name)
{
	for (; list->theirs; list++)
		if (strcasecmp(name, list->theirs) == 0)
			return list->ours;
	return NULL;
}

const char *column_canonical_name(const char *name)
{
	static const alias list[] = {
		{ "diffuse_red", "red" },
		{ "diffuse_green", "green" },
		{ "diffuse_blue", "blue" },
		{ "normal_x", "nx" },
		{ "normal_y", "ny" },
		{ "normal_z", "nz" },
		{ "x", "x" },
		{ "y", "y" },
		{ "z", "z" },
		{ "nx", "nx" },
		{ "ny", "ny" },
		{ "nz", "nz" },
		{ "red", "red" },
		{ "green", "green" },
		{ "blue", "blue" },
		{ "alpha", "alpha" },
		{ "opacity", "opacity" },
		{ "intensity", "intensity" },
		{ NULL, NULL },
	};
	const char *ours = find(list, name);
	return ours ? ours : name;
}

const char *column_table_name(const char *name)
{
	static const alias list[] = {
		{ "i", "intensity" }, { "reflectance", "intensity" },
		{ "normalx", "nx" },  { "normaly", "ny" },
		{ "normalz", "nz" },  { "normal x", "nx" },
		{ "normal y", "ny" }, { "normal z", "nz" },
		{ "easting", "x" },   { "northing", "y" },
		{ "elevation", "z" }, { NULL, NULL },
	};
	const char *ours = find(list, name);
	return ours ? ours : column_canonical_name(name);
}
