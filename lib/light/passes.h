/*
 * passes.h - the compute passes of the light transport: one table, created when first run, so that
 * a bake pays only for the passes its scene calls for.
 */
#ifndef PASSES_H
#define PASSES_H

#include "octree/octree.h"

typedef enum gw_pass_id {
	GW_PASS_LIGHT_VISIBILITY,
	GW_PASS_SHADOW_MAP_SPLAT,
	GW_PASS_SHADOW_MAP_VISIBILITY,
	GW_PASS_LIGHT_IRRADIANCE,
	GW_PASS_LOBE_DIRECT,
	GW_PASS_RECORD_PLACE,
	GW_PASS_RECORD_BLOCK,
	GW_PASS_RECORD_RAYS,
	GW_PASS_RECORD_KEEP,
	GW_PASS_RECORD_AGAIN,
	GW_PASS_RECORD_EMITTERS,
	GW_PASS_RECORD_SKY,
	GW_PASS_RECORD_DIRECTIONS,
	GW_PASS_RECORD_OPENINGS,
	GW_PASS_OPENING_LIGHT,
	GW_PASS_RECORD_FIRST,
	GW_PASS_RECORD_GATHER,
	GW_PASS_RECORD_ADD,
	GW_PASS_LOBE_WEIGHTS,
	GW_PASS_LOBE_SHADE,
	GW_PASS_BRICK_INJECT,
	GW_PASS_BRICK_MIPMAP,
	GW_PASS_RECORD_CONES,
	GW_PASS_READ_BACK,
	GW_PASS_PIXEL_RAYS,
	GW_PASS_PIXEL_CONE,
	GW_PASS_PIXEL_BRICKS,
	GW_PASS_CELL_BRICKS,
	GW_PASS_COUNT
} gw_pass_id;

typedef struct gw_passes {
	gw_gpu *gpu;
	uint32_t constant[4]; /* octree depth, directory level, bits of the cell slack, large discs */
	gw_pass *pass[GW_PASS_COUNT];
	double device_seconds[GW_PASS_COUNT]; /* by timestamps, so far */
	uint32_t threads; /* of the host's loops that stand in for passes; 0: one a processor */
} gw_passes;

/* A set of passes for an octree of that shape; nothing is created yet. */
void gw_passes_init(gw_passes *passes, gw_gpu *gpu, const gw_octree *octree);
void gw_passes_destroy(gw_passes *passes); /* empty afterwards */

/* Do passes that there are fit another octree of the same shape? */
bool gw_passes_fit(const gw_passes *passes, const gw_octree *octree);

/* Runs a pass over count elements, see gw_pass_run; bindings are as the shader lists them. */
gw_status gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
						const void *push, uint64_t count, gw_error *error);

/* Bindings of whole buffers and of windows with `bytes` an element. */
static inline gw_binding gw_whole(const gw_buffer *buffer)
{
	return (gw_binding){ .buffer = (gw_buffer *)(uintptr_t)buffer };
}

static inline gw_binding gw_window(const gw_buffer *buffer, uint32_t bytes)
{
	return (gw_binding){ .buffer = (gw_buffer *)(uintptr_t)buffer, .stride = bytes };
}

static inline gw_binding gw_voxels_of(const gw_image *image)
{
	return (gw_binding){ .image = (gw_image *)(uintptr_t)image };
}

/* What octree_trace.glsl reads of an octree, and octree_discs.glsl, in the order of their lists. */
#define GW_TRACE_BINDINGS(octree)                                                                  \
	gw_whole(&(octree)->ray_directory), gw_whole(&(octree)->node), gw_whole(&(octree)->leaf_tile), \
		gw_whole(&(octree)->lobe_plane), gw_whole(&(octree)->lobe_centre)
#define GW_DISC_BINDINGS(octree)                                                                   \
	gw_whole(&(octree)->leaf_fragment), gw_whole(&(octree)->fragment_surfel),                      \
		gw_whole(&(octree)->surfel_position), gw_whole(&(octree)->surfel_normal),                  \
		gw_whole(&(octree)->surfel_disc), gw_whole(&(octree)->surfel_clip)
/* And disc_tree.glsl, which comes last. */
#define GW_TREE_BINDING(octree) gw_whole(&(octree)->disc_tree)

#endif
