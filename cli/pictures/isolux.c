#include "pictures/isolux.h"
#include "pictures/false_color.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Share of their depth by which neighbouring pixels of one surface may differ. */
#define SAME_DEPTH 0.05f

/* Letters of a label, usually. */
#define LABEL_LETTERS 5

/* Pixels with less on them have no value. */
#define COVERED 0.5f

static gw_status bad_levels(const char *text, gw_error *error)
{
	return gw_fail(error, GW_ERROR_USAGE,
				   "--isolux is '%.80s', but must be 1 to %d ascending numbers above 0 with commas "
				   "between them, such as 50,100,200",
				   text, ISOLUX_MOST);
}

gw_status isolux_read(const char *text, isolux *lines, gw_error *error)
{
	size_t left = strlen(text);
	const char *at = text;
	*lines = (isolux){ .count = 0 };
	for (;;) {
		double level;
		size_t used = number_read(at, left, &level);
		double before = lines->count ? lines->level[lines->count - 1] : 0.0;
		if (used == 0 || lines->count == ISOLUX_MOST || !(level > before) || !isfinite(level))
			return bad_levels(text, error);
		lines->level[lines->count++] = level;
		at += used;
		left -= used;
		if (left == 0)
			return GW_OK;
		if (*at != ',')
			return bad_levels(text, error);
		at++;
		left--;
	}
}

/* The picture that lines are drawn in. */
typedef struct plate {
	const gw_gbuffer *g;
	float *smooth;                 /* a pixel; NAN: nothing there */
	int64_t label[ISOLUX_MOST][2]; /* where there are some already */
	size_t label_count;
} plate;

static bool same_surface(const gw_gbuffer *g, size_t a, size_t b)
{
	if (!(g->coverage[a] > COVERED && g->coverage[b] > COVERED))
		return false;
	return fabsf(g->depth[a] - g->depth[b]) <= SAME_DEPTH * fminf(g->depth[a], g->depth[b]);
}

/* The mean of what is around a pixel on the same surface. */
static float mean_around(const gw_gbuffer *g, const float *values, size_t pixel, int64_t reach)
{
	int64_t x = (int64_t)(pixel % g->width), y = (int64_t)(pixel / g->width);
	double sum = 0.0, count = 0.0;
	if (!(g->coverage[pixel] > COVERED))
		return NAN;
	for (int64_t v = y - reach; v <= y + reach; v++)
		for (int64_t u = x - reach; u <= x + reach; u++) {
			if (u < 0 || v < 0 || u >= (int64_t)g->width || v >= (int64_t)g->height)
				continue;
			size_t other = (size_t)v * g->width + (size_t)u;
			if (!same_surface(g, pixel, other))
				continue;
			sum += (double)values[3 * other];
			count += 1.0;
		}
	return (float)(sum / count);
}

static bool crosses(const plate *p, size_t a, size_t b, double level)
{
	return same_surface(p->g, a, b) &&
		   ((double)p->smooth[a] >= level) != ((double)p->smooth[b] >= level);
}

static bool on_line(const plate *p, size_t x, size_t y, double level)
{
	size_t width = p->g->width, pixel = y * width + x;
	return (x + 1 < width && crosses(p, pixel, pixel + 1, level)) ||
		   (y + 1 < p->g->height && crosses(p, pixel, pixel + width, level));
}

/* Dark on light, light on dark. */
static void draw_pixel(const canvas *c, size_t pixel)
{
	static const uint8_t black[3] = { 0, 0, 0 }, white[3] = { 255, 255, 255 };
	const uint8_t *under = c->pixels + pixel * c->stride;
	double bright = gw_relative_luminance(under[0], under[1], under[2]);
	int64_t x = (int64_t)(pixel % c->width), y = (int64_t)(pixel / c->width);
	canvas_fill(c, x, y, x + c->dot, y + c->dot, bright > 110.0 ? black : white);
}

/* Would a label there cover another? */
static bool covers(const plate *p, const canvas *c, int64_t x, int64_t y)
{
	int64_t wide = LABEL_LETTERS * CANVAS_ADVANCE * c->dot;
	int64_t high = 2 * CANVAS_GLYPH_HEIGHT * c->dot;
	bool covered = false;
	for (size_t i = 0; i < p->label_count; i++)
		covered |= llabs(x - p->label[i][0]) < wide && llabs(y - p->label[i][1]) < high;
	return covered;
}

/* The place of a line that is nearest to its middle, off other labels; false where there is none.
 */
static bool find_place(const plate *p, const canvas *c, const uint8_t *line, const double middle[2],
					   int64_t place[2])
{
	double nearest = INFINITY;
	for (size_t i = 0; i < (size_t)c->width * c->height; i++) {
		int64_t x = (int64_t)(i % c->width), y = (int64_t)(i / c->width);
		double off = hypot((double)x - middle[0], (double)y - middle[1]);
		if (!line[i] || off >= nearest || covers(p, c, x, y))
			continue;
		nearest = off;
		place[0] = x;
		place[1] = y;
	}
	return isfinite(nearest);
}

static void draw_label(const canvas *c, double level, const int64_t place[2])
{
	static const uint8_t dark[3] = { 24, 24, 24 };
	char text[NUMBER_TEXT];
	false_color_number(level, text);
	int64_t dot = c->dot, wide = (int64_t)strlen(text) * CANVAS_ADVANCE * dot;
	int64_t x = place[0] - wide / 2, y = place[1] - CANVAS_GLYPH_HEIGHT * dot / 2;
	canvas_fill(c, x - 2 * dot, y - 2 * dot, x + wide + dot, y + (CANVAS_GLYPH_HEIGHT + 2) * dot,
				dark);
	canvas_write(c, text, x, y);
}

static void draw_level(plate *p, const canvas *c, double level, uint8_t *line)
{
	size_t width = p->g->width, height = p->g->height;
	double middle[2] = { 0.0, 0.0 }, count = 0.0;
	for (size_t y = 0; y < height; y++)
		for (size_t x = 0; x < width; x++) {
			line[y * width + x] = on_line(p, x, y, level);
			if (!line[y * width + x])
				continue;
			middle[0] += (double)x;
			middle[1] += (double)y;
			count += 1.0;
		}
	for (size_t i = 0; i < width * height; i++)
		if (line[i])
			draw_pixel(c, i);
	middle[0] /= count;
	middle[1] /= count;
	/* A line that is a few dots has no room for its number. */
	int64_t *place = p->label[p->label_count];
	if (count > 4.0 * CANVAS_ADVANCE * c->dot && find_place(p, c, line, middle, place)) {
		p->label_count++;
		draw_label(c, level, place);
	}
}

gw_status isolux_draw(const isolux *lines, const gw_gbuffer *g, const float *values,
					  const canvas *c, gw_error *error)
{
	size_t pixels = (size_t)g->width * g->height;
	if (lines->count == 0)
		return GW_OK;
	plate p = { .g = g, .smooth = calloc(pixels, sizeof *p.smooth) };
	uint8_t *line = calloc(pixels, 1);
	gw_status status = GW_OK;
	if (!p.smooth || !line)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for isolux lines");
	for (size_t i = 0; i < pixels && status == GW_OK; i++)
		p.smooth[i] = mean_around(g, values, i, 1 + (int64_t)g->height / 300);
	for (size_t i = 0; i < lines->count && status == GW_OK; i++)
		draw_level(&p, c, lines->level[i], line);
	free(line);
	free(p.smooth);
	return status;
}
