/*
 * host_trace.h - rays through the octree as a function of the host: octree_trace.glsl and
 * octree_discs.glsl, and disc_tree.glsl, step by step, but for roundings.
 *
 * For devices that are the host's own processor (see passes.h). There eight rays of a pass walk
 * in step and fetch lane by lane; one ray after the other takes a fraction of their time.
 */
#ifndef HOST_TRACE_H
#define HOST_TRACE_H

#include "surfels/disc_tree.h"
#include "octree/octree_bindings.h"
#include "base/shader_math.h"

/* What rays read of an octree: arrays as octree.h describes them. */
typedef struct gw_tracer {
	uint32_t depth, directory_level;
	float slack; /* how far a plane reaches beyond its cell */
	float side, nudge;
	const uint32_t *ray_directory, *node, *leaf_tile, *leaf_fragment, *fragment_surfel;
	const float *lobe_plane, *lobe_centre;
	const float *place, *facing, *disc, *clip; /* of surfels */
	gw_disc_tree large;                        /* not its own */
} gw_tracer;

/* One ray, in grid coordinates. */
typedef struct gw_ray {
	gw_vec3 origin, direction; /* unit */
	gw_vec3 facing, foot;      /* of the surface that it leaves: normal, and a place on it */
	float t_max;
	bool both_sides; /* backs of surfaces stop it */
	bool discs;      /* planes count only where discs cover them */
} gw_ray;

typedef struct gw_ray_hit {
	uint32_t lobe; /* slot, or GW_NONE */
	float t;       /* t_max when nothing is hit */
	bool behind;   /* the ray passed the back of a surface */
} gw_ray_hit;

/* A tracer of an octree whose device is the host's processor; it lasts as long as that octree. */
gw_tracer gw_tracer_of(const gw_passes *passes, const gw_octree *octree);

/* The nearest lobe that the ray meets. Thread-safe. */
gw_ray_hit gw_trace(const gw_tracer *tracer, const gw_ray *ray);

#endif
