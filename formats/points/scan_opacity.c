/* scan_opacity.c - see scan_opacity.h. */
#include "points/scan_opacity.h"
#include "glowworm_host.h"

#include "points/scan_color.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const scan_column *scan_opacity_find(const scan *cloud)
{
	const scan_column *column = scan_find_scalar(cloud, "opacity");
	return column ? column : scan_find_scalar(cloud, "alpha");
}

/* Some programs declare bytes as signed: -1 is then 255. */
static double value_of(const scan_column *column, size_t i)
{
	double value = scan_value(column, i);
	return column->type == SCAN_INT8 && value < 0.0 ? value + 256.0 : value;
}

double scan_opacity_full(const scan_column *column, size_t count)
{
	double most = 0.0;
	bool whole = true;
	if (column->type == SCAN_UINT8 || column->type == SCAN_INT8)
		return 255.0;
	for (size_t i = 0; i < count; i++) {
		double value = value_of(column, i);
		most = fmax(most, value);
		whole = whole && value == floor(value);
	}
	if (column->type == SCAN_FLOAT32 || column->type == SCAN_FLOAT64)
		return most > 1.0 && most <= 255.0 && whole ? 255.0 : 1.0;
	return most <= 1.0 ? 1.0 : most <= 255.0 ? 255.0 : 65535.0;
}

static gw_status fill(const scan *cloud, const scan_opacity_told *told, float *opacity,
					  bool *opaque, gw_error *error)
{
	const scan_column *column = scan_opacity_find(cloud);
	double full = told ? told->full : scan_opacity_full(column, cloud->count);
	bool none = true, all = true;
	for (size_t i = 0; i < cloud->count; i++) {
		double value = value_of(column, i);
		if (!(value >= 0.0 && value <= full))
			return gw_fail(
				error, GW_ERROR_DATA,
				"the %s of point %zu is %s, but has to be from 0 to %s: mend it, or give "
				"all points the same with --opacity",
				column->name, i + 1, GW_SAID(value, 6), GW_SAID(full, 6));
		opacity[i] = (float)(value / full);
		none = none && opacity[i] == 0.0f;
		all = all && opacity[i] == 1.0f;
	}
	*opaque = told ? told->opaque : all || (none && strstr(column->name, "alpha"));
	return GW_OK;
}

gw_status scan_opacity_make(const scan *cloud, const scan_opacity_told *told, float **opacity,
							gw_error *error)
{
	bool opaque = true;
	*opacity = NULL;
	if (!scan_opacity_find(cloud) || cloud->count == 0)
		return GW_OK;
	*opacity = reallocarray(NULL, cloud->count, sizeof **opacity);
	if (!*opacity)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for opacities of %zu points",
					   cloud->count);
	gw_status status = fill(cloud, told, *opacity, &opaque, error);
	if (status == GW_OK && !opaque)
		return GW_OK;
	free(*opacity);
	*opacity = NULL;
	return status;
}
