#include "points/scan_color.h"

#include <math.h>
#include <stdlib.h>
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

/* What colours may count up to, and how far values may go beyond it: computed ones come out a
 * little over 1. */
static const double full_of[SCAN_COLOR_FULLS] = { 1.0, 255.0, 1023.0, 4095.0, 65535.0 };
static const double most_of[SCAN_COLOR_FULLS] = { 1.5, 255.0, 1023.0, 4095.0, 65535.0 };
#define FULLS SCAN_COLOR_FULLS
#define ODD 1000 /* one in so many values may be larger than full */

/* Counts values above each of the limits; what is larger than all of them, and bad, is none. */
static void count_above(const scan_column *column, size_t count, uint64_t above[FULLS],
						double *largest)
{
	for (size_t i = 0; i < count; i++) {
		double value = unwrapped(column, i);
		if (!(value > 0.0) || !isfinite(value))
			continue;
		*largest = fmax(*largest, value);
		for (size_t f = 0; f < FULLS && value > most_of[f]; f++)
			above[f]++;
	}
}

/* Other programs' names of colours, in any case. */
static const char *const other_names[][3] = { { "r", "g", "b" },
											  { "rf", "gf", "bf" },
											  { "diffuse_red", "diffuse_green", "diffuse_blue" } };

static bool is_called(const char *own, const char *name)
{
	static const char prefix[] = "scalar_";
	if (strncmp(own, prefix, sizeof prefix - 1) == 0)
		own += sizeof prefix - 1;
	return strcasecmp(own, name) == 0;
}

static const scan_column *find_other(const scan *cloud, const char *name)
{
	for (size_t c = 0; c < cloud->column_count; c++)
		if (is_called(cloud->column[c].name, name))
			return &cloud->column[c];
	return NULL;
}

bool scan_color_may_be_packed(const char *name)
{
	return is_called(name, "rgb") || is_called(name, "rgba");
}

static bool find_columns(const scan *cloud, const char *const name[3], scan_color *color)
{
	bool found = scan_find_triple(cloud, name, color->column);
	size_t others = name == scan_color_names ? sizeof other_names / sizeof *other_names : 0;
	for (size_t n = 0; n < others && !found; n++) {
		found = true;
		for (int k = 0; k < 3; k++)
			found = (color->column[k] = find_other(cloud, other_names[n][k])) && found;
	}
	return found;
}

void scan_color_tally_settle(const scan_color_tally *tally, scan_color *color)
{
	size_t full = tally->floats ? 0 : 1;
	while (full + 1 < FULLS && tally->above[full] > 3 * tally->count / ODD)
		full++;
	color->range = full_of[full];
	color->black = tally->largest <= 0.0;
	color->told = !color->black && tally->wide && color->range != (tally->floats ? 1.0 : 65535.0);
}

bool scan_color_tally_add(scan_color_tally *tally, const scan *part, const char *const name[3],
						  scan_color *color)
{
	if (!find_columns(part, name, color))
		return false;
	for (int k = 0; k < 3; k++) {
		scan_type type = color->column[k]->type;
		tally->floats = tally->floats || type == SCAN_FLOAT32 || type == SCAN_FLOAT64;
		tally->wide = tally->wide || (type != SCAN_UINT8 && type != SCAN_INT8);
		count_above(color->column[k], part->count, tally->above, &tally->largest);
	}
	tally->count += part->count;
	scan_color_tally_settle(tally, color);
	return true;
}

bool scan_color_find(const scan *cloud, const char *const name[3], scan_color *color)
{
	scan_color_tally tally = { 0 };
	return scan_color_tally_add(&tally, cloud, name, color);
}

/* The 32 bits of a packed colour; false when the value is none. PCL stores the bits of an integer
 * as a float, which is below the least normal one, or not a number where alpha is full. */
static bool packed_bits(const scan_column *column, size_t i, uint32_t *bits)
{
	double value = scan_value(column, i);
	if (column->type == SCAN_FLOAT32) {
		memcpy(bits, (const float *)column->data + i, sizeof *bits);
		if (fabs(value) < 0x1p-126 || isnan(value))
			return true;
	}
	if (column->type == SCAN_INT32 && value < 0.0)
		value += 0x1p32;
	if (!(value >= 0.0 && value < 0x1p32 && value == floor(value)))
		return false;
	*bits = (uint32_t)value;
	return true;
}

static bool is_packed(const scan_column *column, size_t count)
{
	bool wide = column->type == SCAN_UINT32 || column->type == SCAN_INT32 ||
				column->type == SCAN_FLOAT32 || column->type == SCAN_FLOAT64;
	uint32_t bits = 0, all = 0;
	for (size_t i = 0; i < count && wide; i++) {
		wide = packed_bits(column, i, &bits);
		all |= bits;
	}
	return wide && all > 0xffff;
}

gw_status scan_color_unpack(scan *cloud, gw_error *error)
{
	scan_color color;
	const scan_column *packed = find_other(cloud, "rgb");
	if (!packed)
		packed = find_other(cloud, "rgba");
	if (!packed || scan_color_find(cloud, scan_color_names, &color) ||
		!is_packed(packed, cloud->count))
		return GW_OK;
	size_t place = (size_t)(packed - cloud->column);
	for (int k = 0; k < 3; k++) {
		scan_column *to = scan_add_column(cloud, scan_color_names[k], SCAN_UINT8, error);
		if (!to)
			return GW_ERROR_MEMORY;
		uint32_t bits = 0;
		for (size_t i = 0; i < cloud->count; i++)
			if (packed_bits(&cloud->column[place], i, &bits))
				((uint8_t *)to->data)[i] = (uint8_t)(bits >> (16 - 8 * k));
	}
	scan_column moved[3], *column = cloud->column;
	size_t first = cloud->column_count - 3;
	memcpy(moved, column + first, sizeof moved);
	scan_column old = column[place];
	memmove(column + place + 3, column + place + 1, (first - place - 1) * sizeof *column);
	memcpy(column + place, moved, sizeof moved);
	cloud->column_count--;
	free(old.name);
	free(old.data);
	return GW_OK;
}

double scan_color_value(const scan_color *color, int k, size_t i)
{
	return unwrapped(color->column[k], i) / color->range;
}

#define BLANK_LEAST 100   /* one in so many points, at least, that are blank */
#define BLANK_TIMES 4     /* as many of them as of points that are nearly black */
#define NEARLY_BLACK 0.04 /* of full, encoded */

bool scan_color_is_black(const scan_color *color, size_t i)
{
	return scan_value(color->column[0], i) == 0.0 && scan_value(color->column[1], i) == 0.0 &&
		   scan_value(color->column[2], i) == 0.0;
}

static bool is_grey(const scan_color *color, size_t i)
{
	double red = scan_value(color->column[0], i), green = scan_value(color->column[1], i);
	return red == green && green == scan_value(color->column[2], i);
}

size_t scan_color_count_blank(const scan_color *color, size_t count)
{
	size_t blank = 0, dark = 0, grey = 0;
	for (size_t i = 0; i < count; i++) {
		bool black = scan_color_is_black(color, i);
		blank += black;
		grey += !black && is_grey(color, i);
		dark += !black && scan_color_value(color, 0, i) < NEARLY_BLACK &&
				scan_color_value(color, 1, i) < NEARLY_BLACK &&
				scan_color_value(color, 2, i) < NEARLY_BLACK;
	}
	bool colored = 2 * grey < count - blank;
	bool many = blank >= BLANK_LEAST && blank > count / BLANK_LEAST && blank > BLANK_TIMES * dark;
	return colored && many ? blank : 0;
}

double scan_srgb_decode(double encoded)
{
	return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

double scan_srgb_encode(double linear)
{
	return linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}
