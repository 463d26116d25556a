#include "page/page_json.h"
#include "options/preview.h"
#include "pictures/false_color.h"
#include "program/json_writer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RAMP 256 /* colours of a scale */

static void put_units(json_writer *json, const page_scene *page)
{
	bool photometric = page->scene.photometric;
	json_put_open_flat(json, "units", '{');
	json_put_text(json, "radiance", photometric ? "cd/m\xc2\xb2" : "W/(sr m\xc2\xb2)");
	json_put_text(json, "irradiance", photometric ? "lx" : "W/m\xc2\xb2");
	json_put_text(json, "radianceName", photometric ? "luminance" : "radiance");
	json_put_text(json, "irradianceName", photometric ? "illuminance" : "irradiance");
	json_put_close(json, '}');
}

/* What a coordinate counts; degrees are metres of a projection. */
static void put_length(json_writer *json, const page_scene *page)
{
	const coordinates *place = &page->scene.place;
	json_put_open(json, "length", '[');
	for (int k = 0; k < 3; k++) {
		double metres = place->projected ? 1.0 : place->scale[k];
		char name[COORDINATES_NAME];
		coordinates_short_name(metres, name);
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", place->projected ? "m (projected)" : name);
		json_put_real(json, "metres", metres);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void put_points(json_writer *json, const page_scene *page, const page_points *points)
{
	const gw_surfels *s = &page->scene.surfels;
	double corner[3], up[3], side[3];
	for (int k = 0; k < 3; k++) {
		corner[k] = s->origin[k] + (double)s->minimum[k];
		side[k] = (double)s->maximum[k] - (double)s->minimum[k];
	}
	gw_camera_up(page->scene.up, up);
	json_put_count(json, "count", page->order.count);
	json_put_count(json, "inputPoints", page->points);
	json_put_count(json, "block", PAGE_BLOCK);
	json_put_count(json, "row", PAGE_ROW);
	json_put_reals(json, "corner", corner, 3); /* metres, of the points' bounds */
	json_put_reals(json, "side", side, 3);
	json_put_reals(json, "up", up, 3);
	json_put_real(json, "step", points->step);
	json_put_real(json, "radius", points->radius);
	json_put_real(json, "spacing", (double)s->spacing);
	json_put_open_flat(json, "levels", '[');
	for (size_t l = 0; l < PAGE_ORDER_LEVELS; l++) {
		json_put_open(json, NULL, '{');
		json_put_count(json, "end", page->order.end[l]);
		json_put_real(json, "cell", ldexp(page->order.side, -(int)l));
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static gw_status put_lamps(json_writer *json, const page_scene *page)
{
	json_put_open(json, "lamps", '[');
	for (size_t l = 0; l < page->lamp_count; l++) {
		const page_lamp *own = &page->lamp[l];
		char *group = strndup(own->name, own->group);
		if (!group)
			return GW_ERROR_MEMORY;
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", own->name + (own->group ? own->group + 1 : 0));
		json_put_text(json, "column", own->name);
		json_put_text(json, "group", group);
		json_put_real(json, "scale", own->scale);
		json_put_close(json, '}');
		free(group);
	}
	json_put_close(json, ']');
	json_put_bool(json, "whole", page->whole);
	return GW_OK;
}

static void put_setups(json_writer *json, const page_scene *page)
{
	json_put_open(json, "setups", '[');
	for (size_t i = 0; i < page->setup_count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", page->setup[i]);
		json_put_singles(json, "gains", page->gain + 3 * page->lamp_count * i,
						 3 * page->lamp_count);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

/* From within the points one turns the head, from without the scene. */
static bool is_within(const gw_surfels *s, const double at[3])
{
	bool within = true;
	for (int k = 0; k < 3; k++) {
		double local = at[k] - s->origin[k];
		within = within && local > (double)s->minimum[k] && local < (double)s->maximum[k];
	}
	return within;
}

static gw_status put_cameras(json_writer *json, const page_scene *page, gw_error *error)
{
	json_put_open(json, "cameras", '[');
	for (size_t i = 0; i < page->plan.text_count; i++) {
		const gw_viewpoint *view = &page->plan.view[i];
		gw_camera camera; /* is none where it looks straight up */
		GW_TRY(camera_plan_camera(&page->plan, (double)page->scene.surfels.spacing, i, &camera,
								  error));
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", page->camera_name[i]);
		json_put_reals(json, "at", view->at, 3);
		json_put_reals(json, "to", view->to, 3);
		json_put_real(json, "angle", view->angle);
		json_put_real(json, "near", camera.near);
		json_put_real(json, "aspect", page->plan.text[i].placed ? 0.0 : PAGE_ASPECT);
		json_put_bool(json, "inside", is_within(&page->scene.surfels, view->at));
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
	return GW_OK;
}

static void put_look(json_writer *json, const settings *s)
{
	static const char digit[] = "0123456789abcdef";
	const false_color_range range = { .low = 0.0, .high = RAMP - 1.0, .unit = "" };
	char ramp[6 * RAMP + 1];
	for (size_t i = 0; i < RAMP; i++) {
		uint8_t rgb[3];
		false_color_of(&range, (double)i, rgb);
		for (size_t k = 0; k < 3; k++) {
			ramp[6 * i + 2 * k] = digit[rgb[k] >> 4];
			ramp[6 * i + 2 * k + 1] = digit[rgb[k] & 15];
		}
	}
	ramp[6 * RAMP] = '\0';
	json_put_text(json, "ramp", ramp);
	json_put_text(json, "tone", preview_tone_name((preview_tone)s->render.tone));
	json_put_real(json, "exposure", (double)s->exposure); /* null: by what is in view */
}

/* Prints the text without less-than signs, which might end the script element that it stands in. */
static void print_escaped(const char *text, FILE *out)
{
	for (; *text; text++)
		if (*text == '<')
			fputs("\\u003c", out);
		else
			fputc(*text, out);
}

static gw_status put_all(json_writer *json, const settings *s, const page_scene *page,
						 const page_points *points, const char *title, gw_error *error)
{
	json_put_open(json, NULL, '{');
	json_put_text(json, "title", title);
	json_put_text(json, "input", s->input[0].path);
	put_units(json, page);
	if (page->bake_error)
		json_put_text(json, "bakeError", page->bake_error);
	put_length(json, page);
	put_points(json, page, points);
	GW_TRY(put_lamps(json, page));
	put_setups(json, page);
	GW_TRY(put_cameras(json, page, error));
	put_look(json, s);
	json_put_close(json, '}');
	return GW_OK;
}

/* A text that is written to memory; NULL when there is none for it. */
static gw_status end_text(FILE *out, char **text, gw_status status)
{
	bool whole = ferror(out) == 0;
	if (fclose(out) == 0 && whole && status == GW_OK)
		return GW_OK;
	free(*text);
	*text = NULL;
	return status == GW_OK ? GW_ERROR_MEMORY : status;
}

static gw_status make_plain(const settings *s, const page_scene *page, const page_points *points,
							const char *title, char **text, gw_error *error)
{
	size_t length;
	FILE *out = open_memstream(text, &length);
	if (!out)
		return GW_ERROR_MEMORY;
	json_writer json = { .out = out, .lines = true };
	return end_text(out, text, put_all(&json, s, page, points, title, error));
}

static gw_status make_escaped(const char *plain, char **text)
{
	size_t length;
	FILE *out = open_memstream(text, &length);
	if (!out)
		return GW_ERROR_MEMORY;
	print_escaped(plain, out);
	return end_text(out, text, GW_OK);
}

gw_status page_json_make(const settings *s, const page_scene *page, const page_points *points,
						 const char *title, char **text, gw_error *error)
{
	char *plain = NULL;
	*text = NULL;
	gw_status status = make_plain(s, page, points, title, &plain, error);
	if (status == GW_OK)
		status = make_escaped(plain, text);
	free(plain);
	if (status == GW_ERROR_MEMORY)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the page's scene");
	return status;
}
