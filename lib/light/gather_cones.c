/*
 * gather_cones.c - see gather_cones.h.
 */
#include "light/gather_cones.h"

#include <math.h>
#include <stdlib.h>

/* A leaf's faces are taken this much larger than its points' area: with 1, a ray through a wall of
 * scattered points is stopped by 87 %, with 1.5 by 99.7 %. */
#define GAIN 1.5f

/* Leaf cells from the surface (plus half a cell along the normal) to a cone's first sample. */
#define START 0.5f

/* The largest radiance is stored as this: leaves a factor of 60 for sums in coarse voxels. */
#define STORED_LARGEST 1024.0f

/* Lays `bricks` out in rows and layers of an image with six faces behind each other. */
static gw_status lay_out(gw_gpu *gpu, uint64_t bricks, uint32_t row[2], uint32_t *face_depth,
						 uint32_t extent[3], gw_error *error)
{
	uint64_t largest = gw_gpu_limits(gpu)->maxImageDimension3D / 3;
	uint64_t side = (uint64_t)ceil(cbrt((double)(bricks * 6)));
	side = side < 1 ? 1 : side > largest ? largest : side;
	uint64_t layers = (bricks + side * side - 1) / (side * side);
	layers = layers < 1 ? 1 : layers;
	if (layers * 6 > largest)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%llu bricks do not fit into the device's 3D images (%llu at most); use a "
					   "smaller depth or gather by rays",
					   (unsigned long long)bricks,
					   (unsigned long long)(largest / 6 * largest * largest));
	row[0] = row[1] = (uint32_t)side;
	*face_depth = (uint32_t)(3 * layers);
	extent[0] = extent[1] = (uint32_t)(3 * side);
	extent[2] = 6 * *face_depth;
	return GW_OK;
}

static gw_status make_pools(gw_gpu *gpu, const gw_octree *octree, gw_cone_gather *gather,
							gw_error *error)
{
	uint32_t extent[3];
	GW_TRY(lay_out(gpu, octree->leaf_tile_count, gather->leaf_bricks, &gather->leaf_face_depth,
				   extent, error));
	GW_TRY(gw_image_create(gpu, VK_FORMAT_R16G16B16A16_SFLOAT, extent, "leaf pool",
						   &gather->leaf_pool, error));
	GW_TRY(lay_out(gpu, octree->tile_count, gather->mip_bricks, &gather->mip_face_depth, extent,
				   error));
	return gw_image_create(gpu, VK_FORMAT_R16G16B16A16_SFLOAT, extent, "mipmap pool",
						   &gather->mip_pool, error);
}

gw_status gw_cone_gather_create(gw_gpu *gpu, const gw_octree *octree, uint32_t cones, uint32_t seed,
								gw_cone_gather *gather, gw_error *error)
{
	*gather = (gw_cone_gather){ .cones = cones, .seed = seed };
	gw_status status = make_pools(gpu, octree, gather, error);
	if (status != GW_OK)
		gw_cone_gather_destroy(gpu, gather);
	return status;
}

void gw_cone_gather_destroy(gw_gpu *gpu, gw_cone_gather *gather)
{
	gw_image_destroy(gpu, &gather->leaf_pool);
	gw_image_destroy(gpu, &gather->mip_pool);
	gw_cone_gather_forget_marks(gpu, gather);
}

void gw_cone_gather_forget_marks(gw_gpu *gpu, gw_cone_gather *gather)
{
	gw_buffer_destroy(gpu, &gather->record_mark);
	gw_buffer_destroy(gpu, &gather->facet_mark);
	free(gather->looked_into);
	gather->looked_into = NULL;
	gather->marked = 0;
}

gw_cone_push gw_cone_gather_push(const gw_cone_gather *gather, float scale, const float sky[3])
{
	return (gw_cone_push){ .cones = gather->cones,
						   .seed = gather->seed,
						   .scale = scale,
						   .leaf_bricks = { gather->leaf_bricks[0], gather->leaf_bricks[1] },
						   .mip_bricks = { gather->mip_bricks[0], gather->mip_bricks[1] },
						   .leaf_face_depth = gather->leaf_face_depth,
						   .mip_face_depth = gather->mip_face_depth,
						   .gain = GAIN,
						   .start = START,
						   .sky = { sky[0], sky[1], sky[2], 0.0f } };
}

static gw_cone_push push_of(const gw_cone_gather *gather, gw_facet_radiance radiance, float scale,
							const float sky[3])
{
	gw_cone_push push = gw_cone_gather_push(gather, scale, sky);
	push.apart = radiance.apart;
	push.mark = radiance.mark;
	return push;
}

static gw_status inject(gw_passes *passes, const gw_octree *octree, const gw_cone_gather *gather,
						const gw_buffer *facet_radiance, gw_cone_push push, gw_error *error)
{
	const gw_binding leaves[] = { gw_whole(&octree->leaf_tile),
								  gw_whole(&octree->leaf_tile_neighbour),
								  gw_whole(&octree->facet_plane),
								  gw_whole(&octree->facet_centre),
								  gw_whole(facet_radiance),
								  gw_voxels_of(&gather->leaf_pool),
								  gw_whole(&octree->facet_albedo),
								  gw_whole(push.apart ? &gather->facet_mark : &octree->leaf_tile) };
	GW_TRY(gw_passes_run(passes, GW_PASS_BRICK_INJECT, leaves, &push,
						 27 * (uint64_t)octree->leaf_tile_count, error));
	const gw_binding levels[] = { gw_whole(&octree->node), gw_whole(&octree->tile_neighbour),
								  gw_voxels_of(&gather->leaf_pool),
								  gw_voxels_of(&gather->mip_pool) };
	for (uint32_t level = octree->depth - 1; level >= 1; level--) {
		push.level = level;
		push.tile_first = octree->tile_first[level];
		push.from_leaves = level == octree->depth - 1;
		uint64_t tiles = octree->tile_first[level + 1] - octree->tile_first[level];
		GW_TRY(gw_passes_run(passes, GW_PASS_BRICK_MIPMAP, levels, &push, 27 * tiles, error));
	}
	return GW_OK;
}

gw_status gw_cone_gather_fill(gw_passes *passes, const gw_octree *octree,
							  const gw_cone_gather *gather, gw_facet_radiance radiance,
							  float *scale, gw_error *error)
{
	const float black[3] = { 0 };
	*scale = radiance.largest > 0.0f ? STORED_LARGEST / radiance.largest : 1.0f;
	return inject(passes, octree, gather, radiance.facets, push_of(gather, radiance, *scale, black),
				  error);
}

gw_status gw_cone_gather_bounce(const gw_record_context *on, gw_cone_gather *gather,
								gw_facet_radiance radiance, const float sky[3], gw_buffer *gathered,
								gw_error *error)
{
	float scale;
	GW_TRY(gw_cone_gather_fill(on->passes, on->octree, gather, radiance, &scale, error));
	const gw_cone_push push = push_of(gather, radiance, scale, sky);
	const gw_binding bindings[] = { gw_whole(&on->octree->level_directory),
									gw_whole(&on->octree->node),
									gw_voxels_of(&gather->leaf_pool),
									gw_voxels_of(&gather->mip_pool),
									gw_window(&on->records->position, 16),
									gw_window(&on->records->normal, 16),
									gw_window(gathered, 16),
									gw_whole(&on->octree->leaf_tile),
									gw_whole(&on->octree->facet_plane),
									gw_whole(&on->octree->facet_albedo),
									gw_whole(radiance.apart ? &gather->record_mark
															: &on->octree->leaf_tile) };
	return gw_passes_run(on->passes, GW_PASS_RECORD_CONES, bindings, &push, on->records->count,
						 error);
}
