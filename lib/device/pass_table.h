/*
 * pass_table.h - the one table of compute passes: shader, bindings, push constants, and the loop of
 * the processor that does the same, or the reason why there is none.
 *
 * A loop of the processor ("CPU kernel") works on the bytes of the very buffers that the shader
 * would have, where these lie in memory of the processor (gw_gpu_shares_memory). passes.h decides
 * which of the two runs.
 */
#ifndef PASS_TABLE_H
#define PASS_TABLE_H

#include "device/gpu.h"

typedef enum gw_pass_id {
	/* sums and sorting */
	GW_PASS_PREFIX_SUM,
	GW_PASS_RADIX_COUNT,
	GW_PASS_RADIX_SCATTER,
	/* building the octree */
	GW_PASS_OCTREE_FRAGMENTS,
	GW_PASS_OCTREE_INVERT,
	GW_PASS_OCTREE_MARK,
	GW_PASS_OCTREE_UNIQUE,
	GW_PASS_OCTREE_PARENTS,
	GW_PASS_OCTREE_BORDER,
	GW_PASS_OCTREE_LINK,
	GW_PASS_OCTREE_LEAF_TILES,
	GW_PASS_OCTREE_SEED,
	GW_PASS_OCTREE_JOIN,
	GW_PASS_OCTREE_FACETS,
	GW_PASS_OCTREE_FINISH,
	GW_PASS_OCTREE_DISTANCE,
	/* light */
	GW_PASS_LIGHT_VISIBILITY,
	GW_PASS_SHADOW_MAP_SPLAT,
	GW_PASS_SHADOW_MAP_VISIBILITY,
	GW_PASS_LIGHT_IRRADIANCE,
	GW_PASS_FACET_DIRECT,
	GW_PASS_RECORD_PLACE,
	GW_PASS_RECORD_BLOCK,
	GW_PASS_RECORD_RAYS,
	GW_PASS_RECORD_KEEP,
	GW_PASS_RECORD_AGAIN,
	GW_PASS_RECORD_EMITTERS,
	GW_PASS_RECORD_SKY,
	GW_PASS_RECORD_PORTALS,
	GW_PASS_PORTAL_LIGHT,
	GW_PASS_RECORD_FIRST,
	GW_PASS_RECORD_GATHER,
	GW_PASS_RECORD_MOMENTS,
	GW_PASS_RECORD_SHARE,
	GW_PASS_RECORD_ADD,
	GW_PASS_FACET_WEIGHTS,
	GW_PASS_FACET_SHADE,
	GW_PASS_LIGHT_SUM,
	GW_PASS_READ_BACK,
	/* a radiance volume */
	GW_PASS_VOLUME_RAYS,
	GW_PASS_VOLUME_FILL,
	GW_PASS_VOLUME_WEIGHTS,
	GW_PASS_VOLUME_READ,
	GW_PASS_VOLUME_FACES,
	GW_PASS_VOLUME_INJECT,
	GW_PASS_VOLUME_SPREAD,
	/* probes */
	GW_PASS_PROBE_SIGHT,
	GW_PASS_PROBE_RAYS,
	/* cones */
	GW_PASS_RECORD_DIRECTIONS,
	GW_PASS_BRICK_INJECT,
	GW_PASS_BRICK_MIPMAP,
	GW_PASS_RECORD_CONES,
	/* pictures */
	GW_PASS_PIXEL_RAYS,
	GW_PASS_GIVEN_RAYS,
	GW_PASS_PIXEL_CONE,
	GW_PASS_PIXEL_BRICKS,
	GW_PASS_CELL_BRICKS,
	GW_PASS_CACHE_RAYS,
	GW_PASS_CACHE_MIPS,
	GW_PASS_PIXEL_CACHES,
	GW_PASS_COUNT
} gw_pass_id;

#define GW_PASS_CONSTANTS 5u

typedef struct gw_passes gw_passes; /* passes.h */

/*
 * What a shader does, on the processor: with the same bindings, push constants and specialisation
 * constants (passes->constant), over elements 0 to count - 1. Windows begin at element 0. It books
 * its time in passes->device_seconds, or not at all.
 */
typedef void gw_cpu_kernel(gw_passes *passes, const gw_binding *bindings, const void *push,
						   uint64_t count);

typedef struct gw_pass_row {
	const char *shader;   /* shaders/NAME.comp; the pass's name, too */
	const char *bindings; /* one letter each: t texel buffer, w one that is written, s storage
							 buffer, i storage image, m sampled image */
	uint32_t push_bytes;
	uint32_t loop_bound; /* iterations of one invocation, at most; 0 when small */

	/* Samples of an element that one invocation takes: what bounds its loops. A run with more is
	 * made of several. 0: there are none to divide. */
	uint32_t batch;
	uint32_t batch_at; /* of their first and number in the push constants, bytes */

	gw_cpu_kernel *cpu; /* NULL: there is none, for this reason: */
	const char *why;
} gw_pass_row;

const gw_pass_row *gw_pass_row_of(gw_pass_id id);

/* CPU kernels, in the order of the table; each is where its pass is used. */
gw_cpu_kernel gw_cpu_prefix_sum, gw_cpu_radix_count, gw_cpu_radix_scatter;
gw_cpu_kernel gw_cpu_light_visibility, gw_cpu_light_irradiance, gw_cpu_facet_direct;
gw_cpu_kernel gw_cpu_record_rays, gw_cpu_record_again, gw_cpu_record_emitters, gw_cpu_record_sky,
	gw_cpu_record_portals, gw_cpu_portal_light, gw_cpu_record_first, gw_cpu_record_gather,
	gw_cpu_record_moments, gw_cpu_record_share, gw_cpu_record_add;
gw_cpu_kernel gw_cpu_facet_weights, gw_cpu_facet_shade, gw_cpu_read_back;
gw_cpu_kernel gw_cpu_volume_rays, gw_cpu_volume_fill, gw_cpu_volume_weights, gw_cpu_volume_read,
	gw_cpu_volume_faces, gw_cpu_volume_inject, gw_cpu_volume_spread;
gw_cpu_kernel gw_cpu_probe_sight, gw_cpu_probe_rays;
gw_cpu_kernel gw_cpu_given_rays, gw_cpu_cache_rays, gw_cpu_cache_mips, gw_cpu_pixel_caches;

#endif
