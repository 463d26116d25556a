#include "pictures/render_picture.h"
#include "pictures/exr_picture.h"
#include "pictures/false_color.h"
#include "files/number_text.h"
#include "pictures/png_picture.h"
#include "options/preview.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of a lamp at the camera: what a surface seen edge-on still gets. */
#define AMBIENT 0.15f

uint32_t render_view_channels(settings_view view)
{
	switch (view) {
	case SETTINGS_VIEW_RADIANCE:
		return 1u << RENDER_RADIANCE;
	case SETTINGS_VIEW_SHADED:
	case SETTINGS_VIEW_ALBEDO:
		return 1u << RENDER_ALBEDO;
	case SETTINGS_VIEW_DIRECT:
		return 1u << RENDER_DIRECT;
	case SETTINGS_VIEW_INDIRECT:
		return 1u << RENDER_INDIRECT;
	case SETTINGS_VIEW_IRRADIANCE:
		return 1u << RENDER_IRRADIANCE;
	case SETTINGS_VIEW_ILLUMINANCE:
		return 1u << RENDER_ILLUMINANCE;
	case SETTINGS_VIEW_ROI:
		return 1u << RENDER_ROI;
	case SETTINGS_VIEW_NDF:
		return 1u << RENDER_NDF;
	case SETTINGS_VIEW_ERROR:
		return 1u << RENDER_ERROR;
	case SETTINGS_VIEW_GAPS:
		return 1u << RENDER_UNKNOWN;
	case SETTINGS_VIEW_SHADOW:
		return 1u << RENDER_SHADOW;
	case SETTINGS_VIEW_RECORDS:
		return 1u << RENDER_ALBEDO;
	default:
		return 0;
	}
}

bool render_view_is_light(settings_view view)
{
	return view == SETTINGS_VIEW_RADIANCE || view == SETTINGS_VIEW_DIRECT ||
		   view == SETTINGS_VIEW_INDIRECT || view == SETTINGS_VIEW_VOXELS ||
		   view == SETTINGS_VIEW_IRRADIANCE;
}

/* A number from 0 to 1. */
static bool is_share(settings_view view)
{
	return view == SETTINGS_VIEW_NDF || view == SETTINGS_VIEW_OPACITY ||
		   view == SETTINGS_VIEW_SHADOW || view == SETTINGS_VIEW_GAPS;
}

bool render_view_is_number(settings_view view)
{
	return view == SETTINGS_VIEW_DEPTH || view == SETTINGS_VIEW_ROI ||
		   view == SETTINGS_VIEW_ERROR || view == SETTINGS_VIEW_ILLUMINANCE || is_share(view);
}

/* ------------------------------------------------------------------------------ shading */

/* Brightness of a surface in the light of a lamp at the camera. */
static float lamp_at_camera(const gw_gbuffer *g, size_t pixel)
{
	return AMBIENT + (1.0f - AMBIENT) * g->facing[pixel];
}

/* Where a view's numbers stand within the channels of a pixel; -1: somewhere else. */
static int offset_of(const render_scene *scene, settings_view view)
{
	for (int c = 0; c < RENDER_CHANNEL_COUNT; c++)
		if (render_view_channels(view) & 1u << c)
			return scene->offset[c];
	return -1;
}

void render_view_values(const render_scene *scene, const gw_gbuffer *g, settings_view view,
						float *values)
{
	size_t pixels = (size_t)g->width * g->height;
	int offset = offset_of(scene, view);
	bool one = render_view_is_number(view);
	for (size_t i = 0; i < pixels; i++) {
		float *v = values + 3 * i;
		const float *channel = g->channel + i * g->channel_count;
		for (int k = 0; k < 3; k++) {
			if (!(g->coverage[i] > 0.0f))
				v[k] = 0.0f;
			else if (view == SETTINGS_VIEW_DEPTH)
				v[k] = g->depth[i];
			else if (view == SETTINGS_VIEW_NORMAL)
				v[k] = g->normal[3 * i + (size_t)k];
			else
				v[k] = channel[offset + (one ? 0 : k)];
		}
		bool shaded = view == SETTINGS_VIEW_SHADED || view == SETTINGS_VIEW_RECORDS;
		if (shaded && g->coverage[i] > 0.0f) {
			float bright = lamp_at_camera(g, i);
			for (int k = 0; k < 3; k++)
				v[k] *= bright;
		}
	}
}

/* -------------------------------------------------------------------------------- screen */

static const char *unit_of(const render_scene *scene, settings_view view)
{
	if (view == SETTINGS_VIEW_DEPTH || view == SETTINGS_VIEW_ROI)
		return "m";
	if (view == SETTINGS_VIEW_IRRADIANCE || view == SETTINGS_VIEW_ILLUMINANCE)
		return scene->photometric ? "lx" : "W/m^2";
	if (render_view_is_light(view))
		return scene->photometric ? "cd/m^2" : "W/(sr m^2)";
	return "";
}

/* A scale for pictures of numbers, or of light by false colours: one for all of them. */
static gw_status fit_scale(settings_view view, const render_values *pictures, size_t count,
						   false_color_range *range, gw_error *error)
{
	size_t pixels = 0, used = 0;
	for (size_t k = 0; k < count; k++)
		pixels += (size_t)pictures[k].g->width * pictures[k].g->height;
	float *seen = reallocarray(NULL, pixels, sizeof *seen);
	if (!seen)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a scale");
	for (size_t k = 0; k < count; k++) {
		const gw_gbuffer *g = pictures[k].g;
		for (size_t i = 0; i < (size_t)g->width * g->height; i++)
			if (g->coverage[i] > 0.0f)
				seen[used++] = (float)preview_luminance(pictures[k].values + 3 * i);
	}
	bool lux = view == SETTINGS_VIEW_ILLUMINANCE;
	*range = false_color_fit(seen, used, view != SETTINGS_VIEW_DEPTH && !is_share(view) && !lux);
	free(seen);
	if (is_share(view))
		*range = (false_color_range){ 0.0, 1.0, false, "" };
	if (lux)
		range->low = 0.0; /* as measuring instruments have it */
	return GW_OK;
}

/* The colour of a covered pixel on the screen, linear, 0..1. */
static void show(const render_look *look, const float v[3], double scale,
				 const false_color_range *range, double c[3])
{
	uint8_t rgb[3];
	if (range) {
		false_color_of(range, preview_luminance(v), rgb);
		for (int k = 0; k < 3; k++)
			c[k] = scan_srgb_decode(rgb[k] / 255.0);
		return;
	}
	bool normal = look->view == SETTINGS_VIEW_NORMAL;
	for (int k = 0; k < 3; k++)
		c[k] = normal ? scan_srgb_decode(0.5 + 0.5 * (double)v[k])
					  : fmin(fmax((double)v[k], 0.0) * scale, 1e30);
	preview_tone_apply(normal ? PREVIEW_TONE_NONE : (preview_tone)look->tone, c);
}

static void paint(const render_look *look, const gw_gbuffer *g, const float *values,
				  const false_color_range *range, uint8_t *bytes)
{
	double exposure = look->exposure;
	bool alpha = look->background.transparent;
	bool shown = isnan(exposure);
	double scale = shown ? 1.0 : preview_scale(exposure);
	render_look as_is = *look;
	as_is.tone = shown ? PREVIEW_TONE_NONE : look->tone;
	size_t pixels = (size_t)g->width * g->height;
	for (size_t i = 0; i < pixels; i++) {
		double c[3] = { 0.0, 0.0, 0.0 }, cover = (double)g->coverage[i];
		if (cover > 0.0)
			show(&as_is, values + 3 * i, scale, range, c);
		for (int k = 0; k < 3; k++) {
			double mixed = alpha ? c[k] : cover * c[k] + (1.0 - cover) * look->background.rgb[k];
			bytes[k] = (uint8_t)(scan_srgb_encode(mixed) * 255.0 + 0.5);
		}
		if (alpha)
			bytes[3] = (uint8_t)(cover * 255.0 + 0.5);
		bytes += alpha ? 4 : 3;
	}
}

static size_t describe(const render_look *look, char number[NUMBER_TEXT], png_picture_text text[4])
{
	double exposure = look->exposure;
	size_t count = 0;
	text[count++] = (png_picture_text){ "Software", "glowworm " GW_VERSION };
	text[count++] = (png_picture_text){ "Comment", look->command };
	if (!isnan(exposure)) {
		number_print_float(number, (float)exposure);
		text[count++] = (png_picture_text){ "Exposure value", number };
	}
	return count;
}

/* Between pictures of a row, and beside them for the scale; dots of the letters. */
#define ROW_GAP 4
#define ROW_SCALE 76

/* A picture, or several side by side. */
typedef struct sheet {
	const render_look *look;
	const render_row *row;
	const false_color_range *range; /* NULL: no colours that stand for numbers */
	uint32_t width, height;         /* of one picture */
	canvas all;
} sheet;

static bool is_row(const sheet *s)
{
	return s->row->count > 1;
}

/* The name without folders and ending, in a corner. */
static void draw_name(const char *path, const canvas *c)
{
	static const uint8_t dark[3] = { 24, 24, 24 };
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	char text[48];
	snprintf(text, sizeof text, "%s", name);
	char *ending = strrchr(text, '.');
	if (ending && ending > text)
		*ending = '\0';
	int64_t dot = c->dot, wide = (int64_t)strlen(text) * CANVAS_ADVANCE * dot;
	canvas_fill(c, 0, 0, wide + 7 * dot, (CANVAS_GLYPH_HEIGHT + 8) * dot, dark);
	canvas_write(c, text, 4 * dot, 4 * dot);
}

/* Paints one picture by itself, and puts it into the sheet. */
static gw_status lay_picture(const sheet *s, size_t place, gw_error *error)
{
	const render_values *picture = &s->row->picture[place];
	size_t stride = s->all.stride, line = s->width * stride;
	canvas own = { reallocarray(NULL, s->height, line), s->width, s->height, stride, s->all.dot };
	if (!own.pixels)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	paint(s->look, picture->g, picture->values, s->range, own.pixels);
	gw_status status = isolux_draw(&s->look->lines, picture->g, picture->values, &own, error);
	if (is_row(s) && s->row->name)
		draw_name(s->row->name[place], &own);
	size_t left = place * (s->width + (size_t)(ROW_GAP * s->all.dot));
	for (size_t y = 0; y < s->height; y++)
		memcpy(s->all.pixels + (y * s->all.width + left) * stride, own.pixels + y * line, line);
	free(own.pixels);
	return status;
}

static gw_status make_sheet(sheet *s, gw_error *error)
{
	size_t gap = is_row(s) ? ROW_GAP * (size_t)s->all.dot : 0;
	size_t wide = s->row->count * (s->width + gap) - gap;
	if (is_row(s) && s->range)
		wide += ROW_SCALE * (size_t)s->all.dot;
	if (wide > GW_RASTER_SIZE_MAX)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%zu pictures side by side are %zu pixels wide, of at most %u; make them "
					   "smaller with --size",
					   s->row->count, wide, GW_RASTER_SIZE_MAX);
	s->all.width = (uint32_t)wide;
	s->all.height = s->height;
	s->all.pixels = calloc(wide * s->height, s->all.stride);
	if (!s->all.pixels)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	for (size_t i = 0; i < s->row->count; i++)
		GW_TRY(lay_picture(s, i, error));
	if (s->range)
		false_color_draw_scale(s->range, s->all.pixels, s->all.width, s->height, s->all.stride);
	return GW_OK;
}

gw_status render_write_row(output_file *out, const render_scene *scene, const render_look *look,
						   const render_row *row, gw_error *error)
{
	false_color_range range = look->scale;
	bool ranged = render_view_is_number(look->view) || look->false_color;
	if (ranged && !look->scaled)
		GW_TRY(fit_scale(look->view, row->picture, row->count, &range, error));
	range.unit = unit_of(scene, look->view);
	const gw_gbuffer *first = row->picture[0].g;
	sheet s = { look,
				row,
				ranged ? &range : NULL,
				first->width,
				first->height,
				{ .stride = look->background.transparent ? 4 : 3,
				  .dot = canvas_dot(first->height) } };
	gw_status status = make_sheet(&s, error);
	char number[NUMBER_TEXT];
	png_picture_text text[4];
	size_t texts = describe(look, number, text);
	png_picture picture = { .width = s.all.width,
							.height = s.all.height,
							.alpha = s.all.stride == 4,
							.pixels = s.all.pixels,
							.text = text,
							.text_count = texts };
	if (status == GW_OK)
		status = png_picture_write(out, &picture, error);
	free(s.all.pixels);
	return status;
}

gw_status render_write_png(output_file *out, const render_scene *scene, const render_look *look,
						   const gw_gbuffer *g, const float *values, gw_error *error)
{
	const render_values picture = { g, values };
	return render_write_row(out, scene, look, &(render_row){ &picture, NULL, 1 }, error);
}

/* -------------------------------------------------------------------------------- layers */

/* Channels of a file, with room for their names. */
typedef struct layers {
	exr_channel channel[RENDER_CHANNEL_COUNT * 3 + 9];
	char name[RENDER_CHANNEL_COUNT * 3 + 9][32];
	size_t count;
} layers;

static void add_layer(layers *l, const char *layer, const char *suffix, const void *values,
					  size_t stride, bool whole)
{
	snprintf(l->name[l->count], sizeof *l->name, "%s%s%s", layer, *layer && *suffix ? "." : "",
			 suffix);
	l->channel[l->count] = (exr_channel){ l->name[l->count], whole, values, stride };
	l->count++;
}

static void list_layers(layers *l, const render_scene *scene, const gw_gbuffer *g,
						const float *color)
{
	static const char *const rgb[3] = { "R", "G", "B" }, *const xyz[3] = { "X", "Y", "Z" };
	for (int k = 0; k < 3; k++)
		add_layer(l, "", rgb[k], color + k, 3, false);
	add_layer(l, "", "A", g->coverage, 1, false);
	add_layer(l, "", "Z", g->depth, 1, false);
	for (int k = 0; k < 3; k++)
		add_layer(l, "N", xyz[k], g->normal + k, 3, false);
	add_layer(l, "id", "", g->id, 1, true);
	for (int c = 0; c < RENDER_CHANNEL_COUNT; c++) {
		render_channel channel = (render_channel)c;
		uint32_t width = render_channel_width(channel);
		for (uint32_t k = 0; k < width && scene->offset[c] >= 0; k++)
			add_layer(l, render_channel_name(channel), width == 3 ? rgb[k] : "",
					  g->channel + scene->offset[c] + k, g->channel_count, false);
	}
}

gw_status render_write_exr(output_file *out, const render_scene *scene, const render_look *look,
						   const gw_gbuffer *g, const float *values, gw_error *error)
{
	size_t pixels = (size_t)g->width * g->height;
	float *color = reallocarray(NULL, pixels, 3 * sizeof *color);
	if (!color)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	for (size_t i = 0; i < 3 * pixels; i++)
		color[i] = values[i] * g->coverage[i / 3];
	layers l = { .count = 0 };
	list_layers(&l, scene, g, color);
	char number[NUMBER_TEXT];
	exr_text text[4] = { { "software", "glowworm " GW_VERSION },
						 { "comments", look->command },
						 { "units", scene->photometric ? "cd/m^2" : "W/(sr m^2)" } };
	size_t texts = 3;
	if (!isnan(look->exposure)) {
		number_print_float(number, (float)look->exposure);
		text[texts++] = (exr_text){ "exposureValue", number };
	}
	exr_picture picture = { g->width, g->height, l.channel, l.count, text, texts };
	gw_status status = exr_picture_write(out, &picture, error);
	free(color);
	return status;
}
