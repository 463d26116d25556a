/* scene_octree.h - the octree of what a picture shows. */
#ifndef SCENE_OCTREE_H
#define SCENE_OCTREE_H

#include "pictures/render_scene.h"

/* What an octree is for: each needs what those before it do. */
typedef enum scene_octree_use {
	SCENE_OCTREE_RAYS,
	SCENE_OCTREE_CELLS, /* of Salm's octree, with those that only regions of influence reach */
	SCENE_OCTREE_BRICKS /* cones, and what is read from voxels */
} scene_octree_use;

/*
 * Builds it on the device and by the settings of a bake, and tells people when it is coarser than
 * it was to be.
 *   scene    its points' radiance is that of the leaves, 0 where it has none
 *   use      what for
 *   octree   on success to be destroyed by gw_render_octree_destroy
 * Fails as gw_render_octree_create.
 */
gw_status scene_octree_create(const settings *settings, const render_scene *scene,
							  scene_octree_use use, gw_render_octree **octree, gw_error *error);

/* Radiance of the surfels, W/(sr m^2), 3 each, or zeros of an unlit cloud; for free(). NULL without
 * memory. */
float *scene_octree_radiance(const render_scene *scene);

#endif
