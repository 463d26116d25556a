/*
 * host_rays.c - see host_rays.h.
 */
#include "host_rays.h"

#include "host_loop.h"

#define CHUNK_RAYS 4096u /* that a thread follows at a time */

static size_t chunk_of(uint32_t samples)
{
	return CHUNK_RAYS / samples + 1;
}

void gw_host_record_rays(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						 gw_ray_gather *gather)
{
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(octree),   gw_whole(&records->position),
									gw_whole(&records->normal),  gw_whole(&gather->lobe),
									gw_whole(&gather->distance), GW_DISC_BINDINGS(octree),
									GW_TREE_BINDING(octree) };
	gw_record_push push = { .count = UINT32_MAX, .rays = gather->rays, .seed = gather->seed };
	const gw_host_pass pass = { GW_PASS_RECORD_RAYS, gw_kernel_record_rays, bindings, &push, NULL };
	gw_host_run(passes, &pass, (size_t)gather->rays * records->count, CHUNK_RAYS);
}

void gw_host_record_again(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						  const gw_buffer *list, uint32_t count, gw_ray_gather *gather)
{
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(octree),  gw_whole(&records->position),
									gw_whole(&records->normal), gw_whole(list),
									gw_whole(&gather->lobe),    gw_whole(&gather->distance),
									GW_DISC_BINDINGS(octree),   GW_TREE_BINDING(octree) };
	gw_keep_push push = { .count = UINT32_MAX, .rays = gather->rays, .seed = gather->seed };
	const gw_host_pass pass = { GW_PASS_RECORD_AGAIN, gw_kernel_record_again, bindings, &push,
								NULL };
	gw_host_run(passes, &pass, count, CHUNK_RAYS);
}

void gw_host_record_emitters(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 const gw_sampled_sources *sources, const gw_record_push *push,
							 gw_buffer *sampled)
{
	const gw_buffer *radiance = sources->emitters->radiance;
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(octree),
									gw_whole(radiance),
									gw_whole(&sources->emitters->table),
									gw_whole(&records->position),
									gw_whole(&records->normal),
									gw_whole(sampled),
									gw_whole(sources->part ? sources->part : radiance),
									GW_DISC_BINDINGS(octree),
									GW_TREE_BINDING(octree) };
	gw_record_push all = *push;
	if (push->light_samples == 0)
		return;
	all.count = UINT32_MAX;
	all.batch_count = push->light_samples;
	const gw_host_pass pass = { GW_PASS_RECORD_EMITTERS, gw_kernel_record_emitters, bindings, &all,
								NULL };
	gw_host_run(passes, &pass, records->count, chunk_of(push->light_samples));
}

void gw_host_record_sky(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_sky_map *map, const gw_record_push *push, gw_buffer *sampled)
{
	const gw_binding bindings[] = {
		GW_TRACE_BINDINGS(octree),    gw_whole(&map->texel),      gw_whole(&map->alias),
		gw_whole(&records->position), gw_whole(&records->normal), gw_whole(sampled),
		GW_DISC_BINDINGS(octree),     gw_whole(&map->texel), /* for openings, of which there are
																none */
		GW_TREE_BINDING(octree)
	};
	gw_record_push all = *push;
	if (push->sky_samples == 0)
		return;
	all.count = UINT32_MAX;
	all.batch_count = push->sky_samples;
	const gw_host_pass pass = { GW_PASS_RECORD_SKY, gw_kernel_record_sky, bindings, &all, NULL };
	gw_host_run(passes, &pass, records->count, chunk_of(push->sky_samples));
}

void gw_host_record_first(gw_passes *passes, const gw_octree *octree, gw_records *records,
						  const gw_ray_gather *gather, const gw_sampled_sources *sources,
						  const gw_record_push *push, const gw_buffer *sampled,
						  gw_buffer *irradiance)
{
	const gw_buffer *radiance = sources->emitters->radiance;
	const gw_binding bindings[] = { gw_whole(&gather->lobe),
									gw_whole(&gather->distance),
									gw_whole(&octree->lobe_plane),
									gw_whole(radiance),
									gw_whole(sampled),
									gw_whole(&records->position),
									gw_whole(&records->normal),
									gw_whole(irradiance),
									gw_whole(sources->part ? sources->part : radiance),
									gw_whole(radiance) /* for the sky's map, which is not seen */ };
	gw_record_push all = *push;
	all.count = UINT32_MAX;
	const gw_host_pass pass = { GW_PASS_RECORD_FIRST, gw_kernel_record_first, bindings, &all,
								NULL };
	gw_host_run(passes, &pass, records->count, chunk_of(push->rays));
}

void gw_host_light_visibility(gw_passes *passes, const gw_octree *octree, const gw_light_push *push,
							  const gw_buffer *normal, size_t count, gw_buffer *visibility)
{
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(octree), gw_whole(&octree->surfel_position),
									gw_whole(normal),          gw_whole(visibility),
									GW_DISC_BINDINGS(octree),  GW_TREE_BINDING(octree) };
	gw_light_push all = *push;
	all.count = UINT32_MAX;
	const gw_host_pass pass = { GW_PASS_LIGHT_VISIBILITY, gw_kernel_light_visibility, bindings,
								&all, NULL };
	gw_host_run(passes, &pass, count, chunk_of(push->samples));
}

void gw_host_light_irradiance(gw_passes *passes, const gw_octree *octree, const gw_light_push *push,
							  const gw_buffer *normal, const gw_buffer *visibility, size_t count,
							  gw_buffer *irradiance)
{
	const gw_binding bindings[] = { gw_whole(&octree->surfel_position), gw_whole(normal),
									gw_whole(visibility), gw_whole(irradiance) };
	gw_light_push all = *push;
	all.count = UINT32_MAX;
	const gw_host_pass pass = { GW_PASS_LIGHT_IRRADIANCE, gw_kernel_light_irradiance, bindings,
								&all, NULL };
	gw_host_run(passes, &pass, count, CHUNK_RAYS);
}
