/*
 * region_text.h - the part of a scene whose light is asked for, from text: "box 1,2,0 4,6,3", or
 * "camera at 1,2,1.5 to 4,2,1 fov 60".
 */
#ifndef REGION_TEXT_H
#define REGION_TEXT_H

#include "options/camera_text.h"
#include "scene/loaded_scene.h"

/* What a text says, in the coordinates of the inputs. */
typedef struct region_text {
	bool by_camera;
	camera_text camera;
	double low[3], high[3]; /* else: corners of a box */
} region_text;

/* Reads a text. GW_ERROR_USAGE with the place in it. */
gw_status region_text_read(const char *text, region_text *region, gw_error *error);

/* GW_ERROR_USAGE when a bake of a region is asked for something that it has not. */
gw_status region_text_check(const settings *s, gw_error *error);

/* The region as the bake takes it. */
typedef struct region_points {
	gw_region region;
	gw_camera camera;
	uint8_t *point; /* owned, or NULL */
} region_points;

/*
 * Finds the region that from->region asks for in a scene.
 *   points   on success its region, which refers to it, is for gw_bake_options; to be freed with
 *            region_points_clear
 * GW_ERROR_USAGE, GW_ERROR_MEMORY, or GW_ERROR_DATA when no point lies in the box.
 */
gw_status region_points_find(const settings *from, const loaded_scene *scene, region_points *points,
							 gw_error *error);
void region_points_clear(region_points *points);

#endif
