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
	gw_lost_rays lost;
};

/* Rays that leave surfaces. */
typedef struct gw_given_rays {
	gw_pixels from;   /* position: and a number in [0, 1): what is less than opaque ends the ray
						 when no more is left of it; normal: of the surface there */
	const float *way; /* 4 a ray: unit, 0 */
} gw_given_rays;

/*
 * The light along them: of what they meet, or the sky.
 *   reflection   of it the sky
 *   light        4 a ray: radiance, 0
 */
gw_status gw_given_rays_trace(gw_render_octree *octree, const gw_given_rays *rays,
							  const gw_reflection *reflection, float *light, gw_error *error);

/* From metres to grid coordinates. */
void gw_render_octree_to_grid(const gw_render_octree *octree, const float metres[3], float grid[3]);

/* The sky's texels; where there are none, any that passes can have bound. */
gw_binding gw_render_octree_sky(const gw_render_octree *octree);

#endif
