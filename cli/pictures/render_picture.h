/*
 * render_picture.h - from what a camera sees to a picture: shading, exposure, tone map, layers.
 */
#ifndef RENDER_PICTURE_H
#define RENDER_PICTURE_H

#include "files/output_file.h"
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
	render_background background;
	double exposure;     /* EV; NAN: values are shown as they are */
	const char *command; /* for the file's header */
} render_look;

/* Which channels a view needs: 1 << render_channel. */
uint32_t render_view_channels(settings_view view);

/* True for views that are light, to which an exposure belongs. */
bool render_view_is_light(settings_view view);

/*
 * The values of a view: 3 a pixel, linear. Views that are one number have it three times.
 *   values  3 * width * height
 */
void render_view_values(const render_scene *scene, const gw_gbuffer *g, settings_view view,
						float *values);

/*
 * Writes a picture for the screen.
 *   values  of render_view_values
 */
gw_status render_write_png(output_file *out, const render_scene *scene, const render_look *look,
						   const gw_gbuffer *g, const float *values, gw_error *error);

/* Writes all that is known of the picture: R G B A are the view, multiplied by coverage, then every
 * channel as a layer, N.X N.Y N.Z, Z and id. Exposure is a note only. */
gw_status render_write_exr(output_file *out, const render_scene *scene, const render_look *look,
						   const gw_gbuffer *g, const float *values, gw_error *error);

#endif
