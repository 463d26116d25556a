/*
 * render_octree.h - what the octree of a picture holds.
 */
#ifndef RENDER_OCTREE_H
#define RENDER_OCTREE_H

#include "glowworm_picture.h"
#include "light/gather_cones.h"
#include "light/sky_map.h"

/* What gw_render_octree of glowworm_picture.h is. */
struct gw_render_octree {
	gw_gpu *gpu;
	gw_octree octree;
	gw_passes passes;
	gw_buffer surfel_radiance; /* vec4 a surfel */
	gw_buffer facet_radiance;  /* vec4 a facet slot; the mean of its surfels' */
	bool has_bricks;
	gw_cone_gather bricks;
	float scale;    /* of the radiance in the bricks */
	gw_sky_map sky; /* width 0: there is none */
};

#endif
