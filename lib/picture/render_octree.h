/*
 * render_octree.h - what the octree of a picture holds.
 */
#ifndef RENDER_OCTREE_H
#define RENDER_OCTREE_H

#include "glowworm_picture.h"
#include "light/gather_cones.h"
#include "light/sky_map.h"
#include "picture/gloss_cache.h"

/* What gw_render_octree of glowworm_picture.h is. */
struct gw_render_octree {
	gw_gpu *gpu;
	gw_octree octree;
	gw_passes passes;
	gw_buffer surfel_radiance; /* vec4 a surfel */
	gw_buffer facet_radiance;  /* vec4 a facet; the mean of its surfels' */
	bool has_bricks;
	gw_cone_gather bricks;
	float scale;    /* of the radiance in the bricks */
	gw_sky_map sky; /* width 0: there is none */
	gw_cache_seconds cache_seconds;
};

/* From metres to grid coordinates. */
void gw_render_octree_to_grid(const gw_render_octree *octree, const float metres[3], float grid[3]);

/* The sky's texels; where there are none, any that passes can have bound. */
gw_binding gw_render_octree_sky(const gw_render_octree *octree);

#endif
