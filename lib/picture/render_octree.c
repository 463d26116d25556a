/*
 * render_octree.c - see render_octree.h.
 */
#include "picture/render_octree.h"

#include "base/memory.h"
#include "light/direct_light.h"
#include "octree/compartments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------- making */

static float largest_of(const float *values, size_t count)
{
	float largest = 0.0f;
	for (size_t i = 0; i < count; i++)
		largest = fmaxf(largest, values[i]);
	return largest;
}

static gw_status upload_radiance(gw_render_octree *o, const gw_surfels *surfels,
								 const float *radiance, gw_error *error)
{
	float *wide = gw_allocate_zeros(surfels->count, 4 * sizeof *wide);
	if (!wide)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the radiance of %zu surfels",
					   surfels->count);
	for (size_t i = 0; i < 3 * surfels->count; i++)
		wide[i / 3 * 4 + i % 3] = radiance[i];
	uint64_t bytes = 16 * (uint64_t)surfels->count;
	gw_status status =
		gw_buffer_create(o->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "surfel radiance" },
						 &o->surfel_radiance, error);
	if (status == GW_OK)
		status = gw_buffer_upload(o->gpu, &o->surfel_radiance, 0, wide, bytes, error);
	free(wide);
	return status;
}

static gw_status average_facets(gw_render_octree *o, gw_error *error)
{
	uint64_t facets = o->octree.facet_count;
	GW_TRY(
		gw_buffer_create(o->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   16 * facets, "facet radiance" },
						 &o->facet_radiance, error));
	const gw_binding bindings[] = {
		gw_whole(&o->octree.leaf_fragment),   gw_whole(&o->octree.fragment_surfel),
		gw_whole(&o->octree.fragment_weight), gw_whole(&o->surfel_radiance),
		gw_window(&o->facet_radiance, 16),    GW_LEAF_BINDING(&o->octree)
	};
	return gw_passes_run(&o->passes, GW_PASS_FACET_DIRECT, bindings, &(gw_record_push){ 0 }, facets,
						 error);
}

static gw_status fill_bricks(gw_render_octree *o, float largest, gw_error *error)
{
	GW_TRY(gw_cone_gather_create(o->gpu, &o->octree, 1, 0, &o->bricks, error));
	o->has_bricks = true;
	return gw_cone_gather_fill(
		&o->passes, &o->octree, &o->bricks,
		(gw_facet_radiance){ .facets = &o->facet_radiance, .largest = largest }, &o->scale, error);
}

static gw_status make(gw_render_octree *o, const gw_surfels *surfels, const float *radiance,
					  const gw_render_octree_options *options, gw_error *error)
{
	const gw_gpu_options device = { .device = options->device,
									.memory = options->memory,
									.passes = options->passes,
									.validate_synchronization =
										options->validate == GW_VALIDATE_CALLS,
									.validate_gpu_assisted =
										options->validate == GW_VALIDATE_ACCESSES };
	GW_TRY(gw_gpu_create(&device, &o->gpu, error));
	const gw_octree_task task = { .surfels = surfels,
								  .depth = options->depth,
								  .leaf_spacing = options->leaf_spacing,
								  .regions = options->regions || options->bricks };
	GW_TRY(gw_octree_build_task(o->gpu, &task, &o->octree, error));
	gw_octree_passes(&o->passes, o->gpu, &o->octree);
	GW_TRY(upload_radiance(o, surfels, radiance, error));
	GW_TRY(average_facets(o, error));
	return options->bricks ? fill_bricks(o, largest_of(radiance, 3 * surfels->count), error)
						   : GW_OK;
}

gw_status gw_render_octree_create(const gw_surfels *surfels, const float *radiance,
								  const gw_render_octree_options *options, gw_render_octree **made,
								  gw_error *error)
{
	*made = NULL;
	gw_render_octree *o = gw_allocate_zeros(1, sizeof *o);
	if (!o)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for an octree");
	gw_status status = make(o, surfels, radiance, options, error);
	if (status == GW_OK)
		*made = o;
	else
		gw_render_octree_destroy(&o);
	return status;
}

void gw_render_octree_destroy(gw_render_octree **octree)
{
	gw_render_octree *o = *octree;
	*octree = NULL;
	if (!o)
		return;
	if (o->gpu) {
		gw_cone_gather_destroy(o->gpu, &o->bricks);
		gw_sky_map_destroy(o->gpu, &o->sky);
		gw_buffer_destroy(o->gpu, &o->facet_radiance);
		gw_buffer_destroy(o->gpu, &o->surfel_radiance);
		if (o->passes.gpu)
			gw_passes_destroy(&o->passes);
		gw_octree_destroy(o->gpu, &o->octree);
		gw_gpu_destroy(&o->gpu);
	}
	free(o);
}

gw_status gw_render_octree_set_sky(gw_render_octree *o, const gw_light *light, gw_error *error)
{
	gw_sky_map_destroy(o->gpu, &o->sky);
	return light ? gw_sky_map_make(o->gpu, light, &o->sky, error) : GW_OK;
}

/* ------------------------------------------------------------------------- what it is like */

gw_octree_width gw_render_octree_width(const gw_render_octree *octree)
{
	const gw_octree *o = &octree->octree;
	return (gw_octree_width){ (double)o->leaf_size, (double)o->wanted_leaf_size, o->why_coarser };
}

gw_cache_seconds gw_render_octree_cache_seconds(const gw_render_octree *octree)
{
	return octree->cache_seconds;
}

gw_lost_rays gw_render_octree_lost_rays(const gw_render_octree *octree)
{
	return octree->lost;
}

gw_status gw_render_octree_records(gw_render_octree *o, const gw_surfels *surfels,
								   const gw_bake_options *bake, float **position, size_t *count,
								   gw_error *error)
{
	const gw_record_wish wish = { .spacing = bake->record_spacing,
								  .least = gw_records_least(surfels, bake->least_records),
								  .seed = bake->seed };
	gw_records records = { 0 };
	const gw_record_context on = { &o->passes, &o->octree, &records };
	float *cell = NULL;
	*position = NULL;
	*count = 0;
	gw_status status = gw_compartments_find(o->gpu, surfels, bake->threads, &o->octree, error);
	if (status == GW_OK)
		status = gw_records_place(&on, &wish, error);
	if (status == GW_OK) {
		cell = gw_allocate_array(records.count, 4 * sizeof *cell);
		*position = gw_allocate_array(records.count, 3 * sizeof **position);
		status = cell && *position
					 ? gw_buffer_download(o->gpu, &records.position, 0, cell,
										  16 * (uint64_t)records.count, error)
					 : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", records.count);
	}
	if (status == GW_OK) {
		*count = records.count;
		for (size_t i = 0; i < 3 * *count; i++)
			(*position)[i] =
				o->octree.cube_minimum[i % 3] + cell[i / 3 * 4 + i % 3] * o->octree.leaf_size;
	} else {
		free(*position);
		*position = NULL;
	}
	free(cell);
	gw_records_destroy(o->gpu, &records);
	return status;
}

gw_status gw_render_octree_shadow(gw_render_octree *o, const gw_surfels *surfels,
								  const gw_light *light, const gw_bake_options *options,
								  float *share, gw_error *error)
{
	const gw_lit_cloud cloud = {
		.passes = &o->passes, .octree = &o->octree, .surfels = surfels, .options = options
	};
	GW_TRY(gw_compartments_find(o->gpu, surfels, options->threads, &o->octree, error));
	return gw_light_share(&cloud, light, share, error);
}

void gw_render_octree_to_grid(const gw_render_octree *octree, const float metres[3], float grid[3])
{
	const gw_octree *o = &octree->octree;
	for (int k = 0; k < 3; k++)
		grid[k] = (metres[k] - o->cube_minimum[k]) / o->leaf_size;
}

gw_binding gw_render_octree_sky(const gw_render_octree *o)
{
	return gw_whole(o->sky.width > 0 ? &o->sky.texel : &o->surfel_radiance);
}
