#include "pictures/false_color.h"
#include "files/number_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GLYPH_WIDTH 5
#define GLYPH_HEIGHT 7

/* Rows of five dots, the left one being the highest bit. */
typedef struct glyph {
	char letter;
	uint8_t row[GLYPH_HEIGHT];
} glyph;

static const glyph glyphs[] = {
	{ '0', { 0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e } },
	{ '1', { 0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e } },
	{ '2', { 0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f } },
	{ '3', { 0x1e, 0x01, 0x01, 0x0e, 0x01, 0x01, 0x1e } },
	{ '4', { 0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02 } },
	{ '5', { 0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e } },
	{ '6', { 0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e } },
	{ '7', { 0x1f, 0x01, 0x02, 0x04, 0x04, 0x08, 0x08 } },
	{ '8', { 0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e } },
	{ '9', { 0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c } },
	{ '.', { 0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c } },
	{ '-', { 0x00, 0x00, 0x00, 0x0e, 0x00, 0x00, 0x00 } },
	{ '+', { 0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00 } },
	{ '/', { 0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10 } },
	{ '(', { 0x02, 0x04, 0x08, 0x08, 0x08, 0x04, 0x02 } },
	{ ')', { 0x08, 0x04, 0x02, 0x02, 0x02, 0x04, 0x08 } },
	{ '^', { 0x04, 0x0a, 0x11, 0x00, 0x00, 0x00, 0x00 } },
	{ 'W', { 0x11, 0x11, 0x11, 0x15, 0x15, 0x15, 0x0a } },
	{ 'c', { 0x00, 0x00, 0x0e, 0x11, 0x10, 0x11, 0x0e } },
	{ 'd', { 0x01, 0x01, 0x0f, 0x11, 0x11, 0x11, 0x0f } },
	{ 'e', { 0x00, 0x00, 0x0e, 0x11, 0x1f, 0x10, 0x0e } },
	{ 'l', { 0x0c, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e } },
	{ 'm', { 0x00, 0x00, 0x1a, 0x15, 0x15, 0x15, 0x15 } },
	{ 'r', { 0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10 } },
	{ 's', { 0x00, 0x00, 0x0f, 0x10, 0x0e, 0x01, 0x1e } },
	{ 'x', { 0x00, 0x00, 0x11, 0x0a, 0x04, 0x0a, 0x11 } },
};

/* Where the scale goes. */
typedef struct canvas {
	uint8_t *pixels;
	uint32_t width, height;
	size_t stride;
	uint32_t dot; /* pixels a side of a dot of the letters */
} canvas;

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

void false_color_of(const false_color_range *r, double value, uint8_t rgb[3])
{
	static const double stop[][3] = { { 0, 0, 0 },       { 25, 15, 95 },   { 100, 20, 140 },
									  { 190, 45, 110 },  { 240, 105, 45 }, { 252, 175, 30 },
									  { 250, 235, 110 }, { 255, 255, 255 } };
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

static void fill(const canvas *c, int64_t x0, int64_t y0, int64_t x1, int64_t y1,
				 const uint8_t rgb[3])
{
	for (int64_t y = y0 > 0 ? y0 : 0; y < y1 && y < (int64_t)c->height; y++)
		for (int64_t x = x0 > 0 ? x0 : 0; x < x1 && x < (int64_t)c->width; x++) {
			uint8_t *pixel = c->pixels + ((size_t)y * c->width + (size_t)x) * c->stride;
			memcpy(pixel, rgb, 3);
			if (c->stride == 4)
				pixel[3] = 255;
		}
}

static void write_text(const canvas *c, const char *text, int64_t x, int64_t y)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	for (; *text; text++, x += (GLYPH_WIDTH + 1) * (int64_t)c->dot) {
		const glyph *g = NULL;
		for (size_t i = 0; i < sizeof glyphs / sizeof *glyphs; i++)
			if (glyphs[i].letter == *text)
				g = glyphs + i;
		for (int row = 0; row < GLYPH_HEIGHT && g; row++)
			for (int column = 0; column < GLYPH_WIDTH; column++) {
				int64_t left = x + column * (int64_t)c->dot, top = y + row * (int64_t)c->dot;
				if (g->row[row] >> (GLYPH_WIDTH - 1 - column) & 1)
					fill(c, left, top, left + c->dot, top + c->dot, white);
			}
	}
}

/* Three digits say enough. */
static void print_number(char text[NUMBER_TEXT], double value)
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
		print_number(text, fabs(value) < 1e-9 * step ? 0.0 : value);
		fill(c, x, y, x + 3 * (int64_t)c->dot, y + (int64_t)(c->dot + 1) / 2, white);
		write_text(c, text, x + 5 * (int64_t)c->dot, y - GLYPH_HEIGHT * (int64_t)c->dot / 2);
		value = r->logarithmic ? next_label(value, r->high / r->low > 200.0) : value + step;
	}
}

void false_color_draw_scale(const false_color_range *r, uint8_t *pixels, uint32_t width,
							uint32_t height, size_t stride)
{
	static const uint8_t dark[3] = { 24, 24, 24 };
	if (width < 160 || height < 120)
		return;
	canvas c = { pixels, width, height, stride, 1 + height / 600 };
	int64_t dot = c.dot, panel = 64 * dot, left = (int64_t)width - panel;
	int64_t unit = (int64_t)strlen(r->unit) * (GLYPH_WIDTH + 1) * dot;
	left = unit + 8 * dot > panel ? (int64_t)width - unit - 8 * dot : left;
	int64_t top = 24 * dot, length = (int64_t)height - top - 12 * dot;
	fill(&c, left, 0, width, height, dark);
	write_text(&c, r->unit, left + 4 * dot, 6 * dot);
	for (int64_t y = 0; y < length; y++) {
		uint8_t rgb[3];
		double at = 1.0 - (double)y / (double)(length - 1);
		double value =
			r->logarithmic ? r->low * pow(r->high / r->low, at) : r->low + at * (r->high - r->low);
		false_color_of(r, value, rgb);
		fill(&c, left + 4 * dot, top + y, left + 16 * dot, top + y + 1, rgb);
	}
	draw_labels(r, &c, left + 16 * dot, top, length);
}
