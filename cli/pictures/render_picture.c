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
		   view == SETTINGS_VIEW_INDIRECT || view == SETTINGS_VIEW_VOXELS;
}

/* A number from 0 to 1. */
static bool is_share(settings_view view)
{
	return view == SETTINGS_VIEW_NDF || view == SETTINGS_VIEW_OPACITY ||
		   view == SETTINGS_VIEW_SHADOW || view == SETTINGS_VIEW_GAPS;
}

static bool is_number(settings_view view)
{
	return view == SETTINGS_VIEW_DEPTH || view == SETTINGS_VIEW_ROI ||
		   view == SETTINGS_VIEW_ERROR || is_share(view);
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
	bool one = is_number(view);
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

/* Values that the colours of a picture stand for. */
static gw_status fit_range(const render_scene *scene, settings_view view, const gw_gbuffer *g,
						   const float *values, false_color_range *range, gw_error *error)
{
	size_t pixels = (size_t)g->width * g->height, used = 0;
	float *seen = reallocarray(NULL, pixels, sizeof *seen);
	if (!seen)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a scale");
	for (size_t i = 0; i < pixels; i++)
		if (g->coverage[i] > 0.0f)
			seen[used++] = (float)preview_luminance(values + 3 * i);
	bool logarithmic = view != SETTINGS_VIEW_DEPTH && !is_share(view);
	*range = false_color_fit(seen, used, logarithmic);
	free(seen);
	if (is_share(view))
		*range = (false_color_range){ 0.0, 1.0, false, "" };
	if (view == SETTINGS_VIEW_DEPTH || view == SETTINGS_VIEW_ROI)
		range->unit = "m";
	else if (render_view_is_light(view))
		range->unit = scene->photometric ? "cd/m^2" : "W/(sr m^2)";
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

gw_status render_write_png(output_file *out, const render_scene *scene, const render_look *look,
						   const gw_gbuffer *g, const float *values, gw_error *error)
{
	false_color_range range;
	bool ranged = is_number(look->view) || look->false_color;
	gw_status status = ranged ? fit_range(scene, look->view, g, values, &range, error) : GW_OK;
	if (status != GW_OK)
		return status;
	size_t stride = look->background.transparent ? 4 : 3;
	uint8_t *bytes = reallocarray(NULL, (size_t)g->width * g->height, stride);
	if (!bytes)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	paint(look, g, values, ranged ? &range : NULL, bytes);
	if (ranged)
		false_color_draw_scale(&range, bytes, g->width, g->height, stride);
	char number[NUMBER_TEXT];
	png_picture_text text[4];
	size_t texts = describe(look, number, text);
	png_picture picture = { .width = g->width,
							.height = g->height,
							.alpha = stride == 4,
							.pixels = bytes,
							.text = text,
							.text_count = texts };
	status = png_picture_write(out, &picture, error);
	free(bytes);
	return status;
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
