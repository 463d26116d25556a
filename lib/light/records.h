/*
 * records.h - places at which light is gathered (Ward's irradiance records), and the way back from
 * them to facets and surfels.
 *
 * One pipeline serves every method: `place` records on the facets of the octree, `trace` what they
 * see, `shade` what was seen, keep irradiance as the basis, `read back` at facets and surfels by
 * distance, normal, plane and visibility. Rays (gather_rays.h) and cones (gather_cones.h) are two
 * trace steps.
 */
#ifndef RECORDS_H
#define RECORDS_H

#include "octree/octree_bindings.h"

typedef struct gw_records {
	uint32_t count;
	float spacing;        /* with which they were placed, leaf cells */
	float radius;         /* of influence, leaf cells */
	uint32_t block_level; /* octree level of the cells that list them */
	uint32_t block_count;
	uint32_t block_tile_first; /* first tile whose parent cells are blocks */
	uint32_t *facet;           /* on the CPU: where each was placed; NULL for those put elsewhere */
	gw_buffer position; /* R32G32B32A32_SFLOAT: grid coordinates; w: distance to the nearest thing
						   the record saw */
	gw_buffer normal;   /* R32G32B32A32_SFLOAT; w: 1; of a record that sees mostly the
						   backs of surfaces the share of its rays that pass none */
	gw_buffer block_first;  /* R32_UINT, block_count + 1 */
	gw_buffer block_record; /* R32_UINT, count */
	gw_buffer
		first; /* R32G32B32A32_SFLOAT, irradiance that came unreflected from emitters and sky */
	gw_buffer indirect; /* R32G32B32A32_SFLOAT, irradiance that was reflected at least once */
	gw_buffer gathered; /* R32G32B32A32_SFLOAT, of the latest bounce */
	/* R32G32B32A32_SFLOAT, 2 a record, or no buffers: how the first two change where the normal
	 * turns towards each of its tangents, irradiance over the sine of the angle: record_moment.glsl
	 */
	gw_buffer first_moment, indirect_moment;
	uint32_t row_count; /* of facets: one each, behind one that is empty, as those without area have
						   none */
	gw_buffer facet_row;    /* R32_UINT, facet_count: the row of each facet, or 0 */
	gw_buffer facet_record; /* R32G32B32A32_UINT, GW_WEIGHTS * row_count words: see
							  facet_weights.comp */
	gw_buffer facet_weight; /* R32G32B32A32_SFLOAT, likewise */
} gw_records;

/* Records, and what steps that work on them need besides. The octree is the one on whose facets
 * they lie or, of records that were put elsewhere, in whose coordinates. */
typedef struct gw_record_context {
	gw_passes *passes;
	const gw_octree *octree;
	gw_records *records;
} gw_record_context;

/* How close records are to stand. */
typedef struct gw_record_wish {
	float spacing;  /* leaf cells; 0: one on every facet */
	uint32_t least; /* where they would be fewer, they stand closer */
	uint32_t most;  /* where they would be more, farther apart; 0: never */
	uint64_t seed;
} gw_record_wish;

/* Records that stand closer because there are few never do by more than this, leaf cells: facets
 * are about 1 wide. */
#define GW_RECORD_SPACING_LEAST 0.8f

/*
 * Places records on the facets by dart throwing: in a random but fixed order, a facet gets a record
 * unless one with a like normal lies nearer than `spacing` leaf cells on the same surface; so every
 * facet lies within that distance of a record. spacing 0: one on every facet (Salm 4.4.3). Where
 * these are too few, it is done again with half the spacing; in such steps, so that
 * scenes that differ little mostly have the same; where they are too many, with twice the spacing.
 *   on   its records are what is made: what they were before is forgotten
 */
gw_status gw_records_place(const gw_record_context *on, const gw_record_wish *wish,
						   gw_error *error);
void gw_records_destroy(gw_gpu *gpu, gw_records *records);

/* gw_record_wish.least of a cloud, by what gw_bake_options.least_records asks for: more where
 * surface is white. */
uint32_t gw_records_least(const gw_surfels *surfels, uint32_t asked);

/*
 * Adds records until every facet lies within its own spacing of one. Those that there are keep
 * their places and come first, and facets keep those that they take light from; light is forgotten,
 * and the distance to the nearest thing.
 *   on              its records were placed with a spacing above 0; or there are none yet, but a
 *                   spacing
 *   facet_spacing   facet_count: each facet's own, at most that; INFINITY for those that need
 *                   none
 */
gw_status gw_records_add(const gw_record_context *on, uint64_t seed, const float *facet_spacing,
						 gw_error *error);

/* How many of their spacings far facets and surfels look for records where those stand closer.
 * Where surfels look farther, more records speak for them and their noise is averaged; that of
 * facets is averaged by the rays that hit them. */
#define GW_FACET_REACH 1.6f
#define GW_SURFEL_REACH 2.25f

/* Facets or surfels that each have a spacing of records of their own. */
typedef struct gw_own_spacings {
	const float *spacing; /* count, leaf cells */
	const bool *closer;   /* count: those that are false keep the records that they have */
	size_t count;
} gw_own_spacings;

/*
 * How far such facets or surfels look for records that stand closer, as a buffer for the functions
 * below: reach times their spacing, at most the records' radius; 0 for those that keep theirs.
 *   buffer    receives a texel buffer, owned by the caller on success
 */
gw_status gw_records_reach(gw_gpu *gpu, const gw_records *records, float reach,
						   const gw_own_spacings *own, gw_buffer *buffer, gw_error *error);

/* Makes room for the light of `count` records: first, indirect and gathered, all dark. */
gw_status gw_records_make_room(gw_gpu *gpu, gw_records *records, gw_error *error);

/*
 * Puts records where the caller says, to gather there; they are not listed, so that nothing can be
 * read back from them.
 *   position   4 * count, grid coordinates and 0
 *   normal     4 * count, unit normals and 0
 */
gw_status gw_records_put(gw_gpu *gpu, const float *position, const float *normal, uint32_t count,
						 gw_records *records, gw_error *error);

/* Makes room for moments of their light, unless there is; or gives it back. */
gw_status gw_records_make_moments(gw_gpu *gpu, gw_records *records, gw_error *error);
void gw_records_drop_moments(gw_gpu *gpu, gw_records *records);

/* Luminance of all the irradiance that records gathered; light receives one a record. */
gw_status gw_records_light(gw_gpu *gpu, const gw_records *records, double *light, gw_error *error);

/* Finds the records each facet's irradiance is interpolated from. Needs record position w.
 *   reach   NULL, or how far each looks, a texel buffer R32_SFLOAT of facet_count; those of 0
 *           keep what they have */
gw_status gw_records_weigh_facets(const gw_record_context *on, const gw_buffer *reach,
								  gw_error *error);

/* Some surfels, and where the records that light them go. */
typedef struct gw_surfel_rows {
	uint64_t first, count;    /* surfels */
	gw_buffer record, weight; /* storage buffers of at least GW_SURFEL_WEIGHTS * count words: see
								 read_back.comp */
} gw_surfel_rows;

/*
 * Finds the records that the light of these surfels is interpolated from.
 * read_back.h does so for all of them.
 *   reach   NULL, or how far each looks, a texel buffer R32_SFLOAT, one a surfel of all; those of
 *           0 get an empty row
 */
gw_status gw_records_weigh_surfels(const gw_record_context *on, const gw_buffer *reach,
								   const gw_surfel_rows *rows, gw_error *error);

#endif
