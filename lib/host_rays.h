/*
 * host_rays.h - the passes that trace rays, as loops of the host over their kernels (kernel.h).
 *
 * A rounding may turn a ray that grazes an edge from one lobe to its neighbour.
 */
#ifndef HOST_RAYS_H
#define HOST_RAYS_H

#include "gather_rays.h"
#include "transport_layout.h"

/* record_rays.comp: gather->lobe and gather->distance, of all rays of all records. */
void gw_host_record_rays(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						 gw_ray_gather *gather);

/* record_again.comp: the same of `count` rays alone.
 *   list   R32_UINT, their number and then these */
void gw_host_record_again(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						  const gw_buffer *list, uint32_t count, gw_ray_gather *gather);

/* record_emitters.comp, and record_sky.comp where there are no openings: all samples of a record at
 * once.
 *   push      what the passes get, but for batches
 *   sampled   vec4 a record: receives what the emitters bring, and what the map adds */
void gw_host_record_emitters(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 const gw_sampled_sources *sources, const gw_record_push *push,
							 gw_buffer *sampled);
void gw_host_record_sky(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_sky_map *map, const gw_record_push *push, gw_buffer *sampled);

/* record_first.comp, where rays see no map of the sky.
 *   sampled      vec4 a record, what the samples brought
 *   irradiance   receives vec4 a record */
void gw_host_record_first(gw_passes *passes, const gw_octree *octree, gw_records *records,
						  const gw_ray_gather *gather, const gw_sampled_sources *sources,
						  const gw_record_push *push, const gw_buffer *sampled,
						  gw_buffer *irradiance);

/* light_visibility.comp, of `count` surfels.
 *   normal       vec4 a surfel: what octree->surfel_normal holds, for lamps
 *   visibility   receives a float a surfel */
void gw_host_light_visibility(gw_passes *passes, const gw_octree *octree, const gw_light_push *push,
							  const gw_buffer *normal, size_t count, gw_buffer *visibility);

/* light_irradiance.comp, of `count` surfels.
 *   irradiance   vec4 a surfel: what the light brings is added */
void gw_host_light_irradiance(gw_passes *passes, const gw_octree *octree, const gw_light_push *push,
							  const gw_buffer *normal, const gw_buffer *visibility, size_t count,
							  gw_buffer *irradiance);

#endif
