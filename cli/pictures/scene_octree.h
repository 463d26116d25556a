/* scene_octree.h - the octree of what a picture shows. */
#ifndef SCENE_OCTREE_H
#define SCENE_OCTREE_H

#include "pictures/render_scene.h"

/*
 * Builds it on the device and by the settings of a bake, and tells people when it is coarser than
 * it was to be.
 *   scene    its points' radiance is that of the leaves, 0 where it has none
 *   bricks   also what cones and the voxels' views need
 *   octree   on success to be destroyed by gw_render_octree_destroy
 * Fails as gw_render_octree_create.
 */
gw_status scene_octree_create(const settings *settings, const render_scene *scene, bool bricks,
							  gw_render_octree **octree, gw_error *error);

/* Radiance of the surfels, W/(sr m^2), 3 each, or zeros of an unlit cloud; for free(). NULL without
 * memory. */
float *scene_octree_radiance(const render_scene *scene);

#endif
