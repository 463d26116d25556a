#include "points/scan_color.h"

#include <math.h>
#include <string.h>
#include <strings.h>

const char *const scan_color_names[3] = { "red", "green", "blue" };
const char *const scan_albedo_names[3] = { "albedo_r", "albedo_g", "albedo_b" };

const scan_column *scan_find_scalar(const scan *cloud, const char *name)
{
	static const char prefix[] = "scalar_";
	size_t length = sizeof prefix - 1;
	const scan_column *column = scan_find(cloud, name);
	for (size_t c = 0; c < cloud->column_count && !column; c++) {
		const char *own = cloud->column[c].name;
		if (strncmp(own, prefix, length) == 0 && strcasecmp(own + length, name) == 0)
			column = &cloud->column[c];
	}
	return column;
}

bool scan_find_triple(const scan *cloud, const char *const name[3], const scan_column *column[3])
{
	for (int k = 0; k < 3; k++)
		column[k] = scan_find_scalar(cloud, name[k]);
	return column[0] && column[1] && column[2];
}

/* Some programs declare bytes of colour as signed: -1 is then 255. */
static double unwrapped(const scan_column *column, size_t i)
{
	double value = scan_value(column, i);
	return column->type == SCAN_INT8 && value < 0.0 ? value + 256.0 : value;
}

static double largest_value(const scan_column *column, size_t count)
{
	double largest = 0.0;
	for (size_t i = 0; i < count; i++) {
		double value = unwrapped(column, i);
		if (value > largest && isfinite(value))
			largest = value;
	}
	return largest;
}

bool scan_color_find(const scan *cloud, const char *const name[3], scan_color *color)
{
	if (!scan_find_triple(cloud, name, color->column))
		return false;
	double largest = 0.0;
	bool floats = false;
	for (int k = 0; k < 3; k++) {
		scan_type type = color->column[k]->type;
		floats = floats || type == SCAN_FLOAT32 || type == SCAN_FLOAT64;
		largest = fmax(largest, largest_value(color->column[k], cloud->count));
	}
	if (floats)
		color->range = largest > 1.0 ? 255.0 : 1.0;
	else
		color->range = largest > 255.0 ? 65535.0 : 255.0;
	color->black = largest <= 0.0;
	return true;
}

double scan_color_value(const scan_color *color, int k, size_t i)
{
	return unwrapped(color->column[k], i) / color->range;
}

double scan_srgb_decode(double encoded)
{
	return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

double scan_srgb_encode(double linear)
{
	return linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}
