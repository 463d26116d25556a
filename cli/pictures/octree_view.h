/*
 * octree_view.h - views of what lies behind the light (Salm, figure 5.1): cells of the octree, what
 * its voxels show, regions of influence and NDFs, places of records, what a lamp sees.
 */
#ifndef OCTREE_VIEW_H
#define OCTREE_VIEW_H

#include "pictures/box_mesh.h"
#include "glowworm_picture.h"
#include "pictures/render_scene.h"

typedef struct octree_view {
	settings_view view;
	uint32_t level, side; /* of cells, borders and voxels */
	size_t lamp;          /* of a shadow: which of the lights */
	const uint8_t *seen;  /* borrowed while opening; of each surfel, whether a picture shows it */
	box_mesh boxes;
	gw_raster_scene raster; /* leads into the above; what is drawn instead of the points, or over
							   them */
	size_t shown;           /* cells, samples or records */
	float size;             /* of a box, metres */
} octree_view;

/* True for views that are drawn as boxes instead of points, and for those over points. */
bool octree_view_is_boxes(settings_view view);
bool octree_view_is_overlay(settings_view view);

/* True for the view of the samples, which shows those that the pictures see. */
bool octree_view_is_samples(settings_view view);

/* True for views of what is found in an octree. */
bool octree_view_needs_octree(settings_view view);

/* Whether a view is of this kind, and what its name goes on with is right: "cells:7". Needs the
 * lights of the scene file. GW_ERROR_USAGE. */
gw_status octree_view_check(const settings *settings, octree_view *view, gw_error *error);

/*
 * Finds what there is to show.
 *   scene   a shadow is put into its channel RENDER_SHADOW
 *   view    checked, with `seen` where octree_view_is_samples; freed with octree_view_clear
 * GW_ERROR_USAGE when the octree has no such level; fails as gw_render_octree_create.
 */
gw_status octree_view_open(settings *settings, render_scene *scene, octree_view *view,
						   gw_error *error);
void octree_view_clear(octree_view *view);

/* The values of pixels that show boxes: 3 a pixel. Cells have dark edges. */
void octree_view_values(const octree_view *view, const gw_camera *camera, const gw_gbuffer *g,
						float *values);

/* Draws the boxes over a picture of the points, where these do not hide them. */
void octree_view_lay_over(const octree_view *view, const gw_camera *camera, const gw_gbuffer *boxes,
						  const gw_gbuffer *points, float *values);

#endif
