/*
 * gather_cones.h - trace step by cones: brick pools of directional voxels, their mipmaps, and cones
 * through them (Salm 4.4.1 to 4.4.3). Every bounce injects, filters and gathers anew.
 *
 * The voxels are not the thesis's: each face holds the area that the leaf's facets show to it and
 * extinction is composited additively, which needs no empirical brightness factor (see
 * record_cones.comp); measured against path traced truth the thesis's opacity is 74-96 % too dark.
 */
#ifndef GATHER_CONES_H
#define GATHER_CONES_H

#include "light/records.h"
#include "light/transport_layout.h"

typedef struct gw_cone_gather {
	uint32_t cones; /* a record */
	uint32_t seed;
	uint32_t leaf_bricks[2], mip_bricks[2];
	uint32_t leaf_face_depth, mip_face_depth;
	gw_image leaf_pool, mip_pool; /* R16G16B16A16_SFLOAT, see brick_pool.glsl */

	/* Marks of compartments, from the first bounce on that asks (cones_apart.h): R32_UINT, of each
	 * record and each facet. */
	gw_buffer record_mark, facet_mark;
	bool *looked_into; /* a mark: does a record have it? Owned */
	uint32_t marked;   /* so many records */
} gw_cone_gather;

/* Allocates the pools. Fails with GW_ERROR_MEMORY and the bytes needed. */
gw_status gw_cone_gather_create(gw_gpu *gpu, const gw_octree *octree, uint32_t cones, uint32_t seed,
								gw_cone_gather *gather, gw_error *error);
void gw_cone_gather_destroy(gw_gpu *gpu, gw_cone_gather *gather);

/* Drops the marks of compartments. */
void gw_cone_gather_forget_marks(gw_gpu *gpu, gw_cone_gather *gather);

/* What the facets send out. */
typedef struct gw_facet_radiance {
	const gw_buffer *facets; /* texel buffer, facet_count vec4 */
	float largest; /* largest component in it: radiance is scaled so that half floats hold it */
	bool apart;    /* only records with the mark gather, from facets that face it or any */
	uint32_t mark; /* then; the gather has the marks */
} gw_facet_radiance;

/*
 * One bounce: injects the radiance of the facets, builds the mipmaps, gathers by cones.
 *   sky        what is seen where a cone is not filled
 *   gathered   receives irradiance, records->count vec4
 */
gw_status gw_cone_gather_bounce(const gw_record_context *on, gw_cone_gather *gather,
								gw_facet_radiance radiance, const float sky[3], gw_buffer *gathered,
								gw_error *error);

/*
 * The first half of a bounce by itself: fills the bricks with the radiance of the facets.
 *   scale   receives what radiance was multiplied by
 */
gw_status gw_cone_gather_fill(gw_passes *passes, const gw_octree *octree,
							  const gw_cone_gather *gather, gw_facet_radiance radiance,
							  float *scale, gw_error *error);

/* What a pass that reads the bricks is pushed. */
gw_cone_push gw_cone_gather_push(const gw_cone_gather *gather, float scale, const float sky[3]);

#endif
