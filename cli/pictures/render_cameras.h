/*
 * render_cameras.h - the cameras of all pictures that are asked for.
 */
#ifndef RENDER_CAMERAS_H
#define RENDER_CAMERAS_H

#include "options/camera_text.h"
#include "pictures/render_scene.h"

/* What --camera, --path and --orbit say. */
typedef struct camera_plan {
	camera_text *text;  /* owned; text_count */
	gw_viewpoint *view; /* owned; text_count, or NULL before the cloud is known */
	size_t text_count;
	uint32_t orbit; /* pictures from each of them, all around */
	char up;        /* as gw_camera_up has it; known once they are placed */
} camera_plan;

/* Reads the options and the path's file. On success freed with camera_plan_clear. */
gw_status camera_plan_read(const settings *settings, camera_plan *plan, gw_error *error);
void camera_plan_clear(camera_plan *plan);

/* How many pictures a plan makes. */
size_t camera_plan_count(const camera_plan *plan);

/*
 * Finds the viewpoints that the texts leave open.
 *   scene    needs luminance and up
 *   surfels  of it; rough ones will do
 *   aspect   width of the picture by its height
 * Fails as gw_viewpoint_find.
 */
gw_status camera_plan_place(camera_plan *plan, const render_scene *scene, const gw_surfels *surfels,
							double aspect, gw_error *error);

/*
 * Marks the surfels that are in some picture or around it, after camera_plan_place. Of many
 * pictures all are.
 *   aspect   width of the pictures by their height
 *   chosen   surfels->count, all 0; receives 1
 * Fails as gw_camera_look.
 */
gw_status camera_plan_choose(const camera_plan *plan, const gw_surfels *surfels, double aspect,
							 uint8_t *chosen, gw_error *error);

/*
 * The camera of a picture, after camera_plan_place.
 *   spacing  of the surfels, metres
 *   picture  below camera_plan_count
 * Fails as gw_camera_look.
 */
gw_status camera_plan_camera(const camera_plan *plan, double spacing, size_t picture,
							 gw_camera *camera, gw_error *error);

#endif
