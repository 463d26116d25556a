/*
 * hit_light.h - what lamps send to the very place that a ray meets, beyond what its facet has.
 *
 * A facet has one light all over: that at the centres of the points that lie in it. Where points
 * are few, that is the light of a place up to a spacing away; records and check points that see the
 * same facets are wrong alike. So check points take the light of the place that a ray meets, as the
 * lamps send it there: how much of it arrives is as of the facet's points. And what checks the
 * octree compares what facets and discs send from there, so that only what rays meet counts.
 */
#ifndef HIT_LIGHT_H
#define HIT_LIGHT_H

#include "light/records.h"
#include "light/shader_functions.h"

typedef struct gw_hit_light_task {
	gw_gpu *gpu;
	const gw_octree *octree;
	const gw_surfels *surfels;
	const gw_buffer *facet_direct; /* irradiance of the facets from lamps */
	const float *direct;           /* 4 a surfel: theirs */
	const gw_light *lights;        /* light_count */
	size_t light_count;
	const gw_bake_options *options;
} gw_hit_light_task;

/* What is read meanwhile. */
typedef struct gw_hit_light {
	gw_hit_light_task task;
	gw_lamp *lamp; /* lamps */
	size_t lamps;
	gw_view albedo, direct;          /* of facets, 4 floats each */
	gw_view leaf;                    /* facet_leaf */
	gw_view first, fragment, weight; /* of leaves */
} gw_hit_light;

/* On success to be closed by the caller; on failure it is empty. */
gw_status gw_hit_light_open(const gw_hit_light_task *task, gw_hit_light *light, gw_error *error);
void gw_hit_light_close(gw_hit_light *light); /* an empty one is fine */

/* A place that a ray meets. */
typedef struct gw_hit_place {
	gw_vec3 at;  /* leaf cells from the cube's corner */
	gw_vec3 way; /* the ray's direction, unit */
} gw_hit_place;

/*
 * The light of a place beyond the facet and beyond points whose discs it lies on, as luminance of
 * radiance.
 *   place    on a plane or a disc; where the surface nearby is bent, that is where the ray meets it
 *   surfel   GW_NONE, or a point: 0 of those that do not lie in the facet
 */
double gw_hit_light_beyond_facet(const gw_hit_light *light, uint32_t facet,
								 const gw_hit_place *place);
double gw_hit_light_beyond_point(const gw_hit_light *light, uint32_t facet, uint32_t surfel,
								 const gw_hit_place *place);

/* A gather of some places: what their rays meet, and how far away. */
typedef struct gw_hit_light_rays {
	const gw_records *place;
	const uint32_t *facet; /* rays a place */
	const float *distance; /* likewise, as in gw_ray_gather */
	uint32_t rays, seed;
} gw_hit_light_rays;

/*
 * Adds the irradiance of places that comes beyond that of the facets.
 *   threads      of the processor
 *   irradiance   4 a place
 */
gw_status gw_hit_light_add(const gw_hit_light *light, const gw_hit_light_rays *rays,
						   uint32_t threads, float *irradiance, gw_error *error);

#endif
