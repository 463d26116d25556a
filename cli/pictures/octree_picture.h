/*
 * octree_picture.h - what a picture takes from an octree: reflections on glossy points, and light
 * sampled from voxels; or from probes.
 */
#ifndef OCTREE_PICTURE_H
#define OCTREE_PICTURE_H

#include "glowworm_picture.h"
#include "glowworm_probes.h"
#include "pictures/render_scene.h"

typedef struct octree_picture {
	gw_render_octree *octree; /* owned; NULL when the picture needs none, as neither probes */
	gw_probes *probes;        /* owned; NULL unless they are to show what is reflected */
	bool glossy, voxels;      /* what it is for */
	bool cubic;
	gw_reflection reflection;
	double build_seconds, seconds; /* to make octree and probes; to read them */
	uint64_t pixels;               /* that were glossy, so far */
} octree_picture;

/* Channels that the pictures of a radiance need besides it: 1 << render_channel. */
uint32_t octree_picture_channels(const settings *settings);

/*
 * Builds the octree, and places probes, if the settings and the points call for them.
 *   scene     lit
 *   picture   on success cleared with octree_picture_clear; empty on failure
 * Fails as gw_render_octree_create and lit_probes_make.
 */
gw_status octree_picture_open(const settings *settings, const render_scene *scene,
							  octree_picture *picture, gw_error *error);
void octree_picture_clear(octree_picture *picture);

/*
 * Changes the radiance of pixels: first to that of the voxels, then by what is reflected. A glossy
 * pixel shows its own emission, what of the diffuse light its gloss leaves, and its reflection.
 *   values   3 * width * height, of the view radiance
 */
gw_status octree_picture_shade(octree_picture *picture, const render_scene *scene,
							   const gw_camera *camera, const gw_gbuffer *gbuffer, float *values,
							   gw_error *error);

#endif
