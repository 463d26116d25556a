/*
 * render_picture.h - from what a camera sees to a picture: shading, exposure, tone map, layers.
 */
#ifndef RENDER_PICTURE_H
#define RENDER_PICTURE_H

#include "files/output_file.h"
#include "pictures/false_color.h"
#include "pictures/isolux.h"
#include "pictures/render_scene.h"

/* A colour behind the points. */
typedef struct render_background {
	bool transparent;
	double rgb[3]; /* linear, 0..1 */
} render_background;

/* How all pictures of a run are made. */
typedef struct render_look {
	settings_view view; /* never SETTINGS_VIEW_AUTO or SETTINGS_VIEW_POINTS */
	int tone;           /* preview_tone */
	bool false_color;   /* of views that are colours */
	bool scaled;        /* numbers are shown by this scale, else by one fitted to each picture */
	false_color_range scale;
	isolux lines;
	render_background background;
	double exposure;     /* EV; NAN: values are shown as they are */
	const char *command; /* for the file's header */
} render_look;

/* Which channels a view needs: 1 << render_channel. */
uint32_t render_view_channels(settings_view view);

/* True for views that are light, to which an exposure belongs. */
bool render_view_is_light(settings_view view);

/* True for views that are one number, which is shown by colours. */
bool render_view_is_number(settings_view view);

/*
 * The values of a view: 3 a pixel, linear. Views that are one number have it three times.
 *   values  3 * width * height
 */
void render_view_values(const render_scene *scene, const gw_gbuffer *g, settings_view view,
						float *values);

/* A picture's pixels, and what they show. */
typedef struct render_values {
	const gw_gbuffer *g;
	const float *values; /* of render_view_values */
} render_values;

/*
 * Writes a picture for the screen.
 *   values  of render_view_values
 */
gw_status render_write_png(output_file *out, const render_scene *scene, const render_look *look,
						   const gw_gbuffer *g, const float *values, gw_error *error);

/* Pictures side by side, all of one size. */
typedef struct render_row {
	const render_values *picture; /* count */
	const char *const *name;      /* count, shown in each's corner; NULL: none */
	size_t count;
} render_row;

/* Writes them as one, with one exposure and one scale. GW_ERROR_USAGE when it would be too wide. */
gw_status render_write_row(output_file *out, const render_scene *scene, const render_look *look,
						   const render_row *row, gw_error *error);

/* Writes all that is known of the picture: R G B A are the view, multiplied by coverage, then every
 * channel as a layer, N.X N.Y N.Z, Z and id. Exposure is a note only. */
gw_status render_write_exr(output_file *out, const render_scene *scene, const render_look *look,
						   const gw_gbuffer *g, const float *values, gw_error *error);

#endif
