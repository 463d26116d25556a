#include "pictures/false_color.h"
#include "pictures/canvas.h"
#include "files/number_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int compare_floats(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

false_color_range false_color_fit(float *values, size_t count, bool logarithmic)
{
	size_t used = 0;
	for (size_t i = 0; i < count; i++)
		if (isfinite(values[i]) && (!logarithmic || values[i] > 0.0f))
			values[used++] = values[i];
	false_color_range range = { 0.1, 1.0, logarithmic, "" };
	if (used == 0)
		return range;
	qsort(values, used, sizeof *values, compare_floats);
	range.high = (double)values[used - 1 - used / 1000];
	range.low = (double)values[logarithmic ? used / 100 : used / 1000];
	if (logarithmic)
		range.low = fmax(range.low, 1e-3 * range.high);
	/* All values may be one. */
	if (!(range.high > range.low * (1.0 + 1e-4)))
		range.high = logarithmic ? range.low * 2.0 : range.low + fmax(fabs(range.low), 1e-6);
	return range;
}

gw_status false_color_read(const char *text, false_color_range *range, gw_error *error)
{
	double side[2];
	const char *behind = text;
	size_t left = strlen(text), used = number_read(text, left, &side[0]);
	bool good = used > 0 && text[used] == ',';
	if (good) {
		behind = text + used + 1;
		left = strlen(behind);
		used = number_read(behind, left, &side[1]);
		good = used > 0;
		behind += used;
	}
	bool logarithmic = good && strcmp(behind, ",log") == 0;
	good = good && (logarithmic || !*behind) && isfinite(side[0]) && isfinite(side[1]) &&
		   side[0] < side[1] && (!logarithmic || side[0] > 0.0);
	if (!good)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--scale is '%.80s', but must be LOW,HIGH, such as 0,500, or LOW,HIGH,log "
					   "with both above 0",
					   text);
	*range = (false_color_range){ side[0], side[1], logarithmic, "" };
	return GW_OK;
}

/* The colours: along the way, lightness rises from 0 to 98 and the hue goes from violet over red to
 * yellow, as colourful as a screen can show but for a tenth, and the way is cut into 32 steps of
 * one length in CIELAB, so that a step looks as large wherever it is. On what to ask of such
 * colours: P. Kovesi, Good Colour Maps: How to Design Them, arXiv:1509.03700, 2015. */
void false_color_of(const false_color_range *r, double value, uint8_t rgb[3])
{
	static const double stop[][3] = {
		{ 0, 0, 0 },       { 11, 7, 21 },     { 19, 11, 33 },    { 22, 13, 43 },
		{ 26, 13, 54 },    { 30, 12, 64 },    { 39, 9, 73 },     { 59, 7, 81 },
		{ 79, 10, 84 },    { 98, 15, 87 },    { 116, 21, 89 },   { 135, 27, 91 },
		{ 152, 32, 92 },   { 169, 38, 92 },   { 185, 43, 90 },   { 200, 48, 88 },
		{ 214, 53, 85 },   { 226, 59, 80 },   { 236, 73, 76 },   { 239, 90, 76 },
		{ 241, 106, 78 },  { 242, 121, 81 },  { 243, 137, 87 },  { 245, 152, 94 },
		{ 246, 167, 104 }, { 247, 182, 116 }, { 248, 197, 131 }, { 248, 211, 149 },
		{ 248, 222, 169 }, { 246, 229, 188 }, { 245, 235, 207 }, { 246, 242, 229 },
		{ 249, 249, 249 },
	};
	const int last = sizeof stop / sizeof *stop - 1;
	double at = r->logarithmic ? log(fmax(value, 1e-300) / r->low) / log(r->high / r->low)
							   : (value - r->low) / (r->high - r->low);
	at = fmin(fmax(at, 0.0), 1.0) * last;
	int before = (int)fmin(at, last - 1);
	for (int k = 0; k < 3; k++) {
		double mixed = stop[before][k] + (at - before) * (stop[before + 1][k] - stop[before][k]);
		rgb[k] = (uint8_t)(mixed + 0.5);
	}
}

/* ------------------------------------------------------------------------------- drawing */

void false_color_number(double value, char text[NUMBER_TEXT])
{
	char digits[NUMBER_TEXT];
	snprintf(digits, sizeof digits, "%.2e", value);
	double rounded = value;
	/* The language's decimal sign may be another; number_read knows only ours. */
	char *sign = strpbrk(digits, ",");
	if (sign)
		*sign = '.';
	number_read(digits, strlen(digits), &rounded);
	number_print(text, rounded);
}

/* The next label's value: 1, 2 and 5 times powers of ten when there is room for them. */
static double next_label(double value, bool coarse)
{
	double power = pow(10.0, floor(log10(value) + 1e-9)), lead = value / power;
	if (coarse)
		return power * 10.0;
	return lead < 1.5 ? power * 2.0 : lead < 3.5 ? power * 5.0 : power * 10.0;
}

static double first_label(const false_color_range *r, double *step)
{
	double span = r->high - r->low, power = pow(10.0, floor(log10(span / 4.0)));
	double lead = span / 4.0 / power;
	*step = power * (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0);
	if (!r->logarithmic)
		return ceil(r->low / *step - 1e-9) * *step;
	double value = pow(10.0, floor(log10(r->low)));
	bool coarse = r->high / r->low > 200.0;
	while (value < r->low * (1.0 - 1e-9))
		value = next_label(value, coarse);
	return value;
}

static void draw_labels(const false_color_range *r, const canvas *c, int64_t x, int64_t top,
						int64_t length)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	double step, value = first_label(r, &step);
	for (int count = 0; value <= r->high * (1.0 + 1e-9) && count < 32; count++) {
		double at = r->logarithmic ? log(value / r->low) / log(r->high / r->low)
								   : (value - r->low) / (r->high - r->low);
		int64_t y = top + (int64_t)((1.0 - at) * (double)(length - 1));
		char text[NUMBER_TEXT];
		false_color_number(fabs(value) < 1e-9 * step ? 0.0 : value, text);
		canvas_fill(c, x, y, x + 3 * (int64_t)c->dot, y + (int64_t)(c->dot + 1) / 2, white);
		canvas_write(c, text, x + 5 * (int64_t)c->dot,
					 y - CANVAS_GLYPH_HEIGHT * (int64_t)c->dot / 2);
		value = r->logarithmic ? next_label(value, r->high / r->low > 200.0) : value + step;
	}
}

void false_color_draw_scale(const false_color_range *r, uint8_t *pixels, uint32_t width,
							uint32_t height, size_t stride)
{
	static const uint8_t dark[3] = { 24, 24, 24 };
	if (width < 160 || height < 120)
		return;
	canvas c = { pixels, width, height, stride, canvas_dot(height) };
	int64_t dot = c.dot, panel = 64 * dot, left = (int64_t)width - panel;
	int64_t unit = (int64_t)strlen(r->unit) * CANVAS_ADVANCE * dot;
	left = unit + 8 * dot > panel ? (int64_t)width - unit - 8 * dot : left;
	int64_t top = 24 * dot, length = (int64_t)height - top - 12 * dot;
	canvas_fill(&c, left, 0, width, height, dark);
	canvas_write(&c, r->unit, left + 4 * dot, 6 * dot);
	for (int64_t y = 0; y < length; y++) {
		uint8_t rgb[3];
		double at = 1.0 - (double)y / (double)(length - 1);
		double value =
			r->logarithmic ? r->low * pow(r->high / r->low, at) : r->low + at * (r->high - r->low);
		false_color_of(r, value, rgb);
		canvas_fill(&c, left + 4 * dot, top + y, left + 16 * dot, top + y + 1, rgb);
	}
	draw_labels(r, &c, left + 16 * dot, top, length);
}
