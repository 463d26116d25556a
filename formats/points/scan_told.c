/* scan_told.c - see scan_told.h. */
#include "points/scan_told.h"

#include <stdlib.h>
#include <string.h>

gw_status scan_told_find(const scan *cloud, scan_told *told, gw_error *error)
{
	*told = (scan_told){ .blank = false };
	if (!scan_color_find(cloud, scan_albedo_names, &told->albedo))
		told->albedo.range = 0.0;
	if (scan_color_find(cloud, scan_color_names, &told->color))
		told->blank = scan_color_count_blank(&told->color, cloud->count) > 0;
	else
		told->color.range = 0.0;
	memset(told->albedo.column, 0, sizeof told->albedo.column);
	memset(told->color.column, 0, sizeof told->color.column);
	const scan_column *column = scan_opacity_find(cloud);
	told->opacity.full = column ? scan_opacity_full(column, cloud->count) : 1.0;
	float *opacity;
	gw_status status = scan_opacity_make(cloud, NULL, &opacity, error);
	told->opacity.opaque = opacity == NULL;
	free(opacity);
	return status;
}

bool scan_told_color(const scan_told *told, const scan *cloud, bool own, scan_color *color)
{
	bool found = scan_color_find(cloud, own ? scan_albedo_names : scan_color_names, color);
	if (!found || !told)
		return found;
	const scan_color *whole = own ? &told->albedo : &told->color;
	color->range = whole->range;
	color->told = whole->told;
	color->black = whole->black;
	return whole->range > 0.0;
}
