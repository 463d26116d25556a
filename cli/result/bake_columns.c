#include "result/bake_columns.h"

#include <stdio.h>

typedef struct column_group {
	const char *name;
	const char *channel; /* letters behind the name and a _, or NULL: one column */
	bool of_light;
} column_group;

static const column_group groups[] = {
	{ "quality", NULL, false },
	{ "scalar_radiance", "rgb", false },
	{ "scalar_direct", "rgb", true },
	{ "scalar_indirect", "rgb", true },
	{ "scalar_irradiance", "rgb", true },
	{ "scalar_direct_irradiance", "rgb", true },
	{ "scalar_indirect_irradiance", "rgb", true },
	{ "scalar_luminance", NULL, true },
	{ "scalar_illuminance", NULL, true },
	{ "scalar_error", NULL, true },
	{ "scalar_roi", NULL, false },
	{ "scalar_ao", NULL, false },
	{ "scalar_bent_normal", "xyz", false },
	{ "scalar_unknown", NULL, false },
	{ "scalar_normal", "xyz", false },
};

size_t bake_columns_remove(scan *cloud, bake_columns which)
{
	size_t before = cloud->column_count;
	for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
		const column_group *g = &groups[i];
		if (which == BAKE_COLUMNS_OF_LIGHT && !g->of_light)
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
