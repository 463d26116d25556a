/*
 * host_rays.h - the passes that trace rays, as loops of the host.
 *
 * As host_products.h: each does what the pass of a shader does, on the same buffers, but for
 * roundings, on devices that are the host's own processor. A rounding may also turn a ray that
 * grazes an edge from one lobe to its neighbour.
 */
#ifndef HOST_RAYS_H
#define HOST_RAYS_H

#include "light/gather_rays.h"
#include "light/host_trace.h"
#include "light/transport_layout.h"

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

/* Share of its power that a light sends towards a place, where it is from there, and how far:
 * light.glsl. */
float gw_lamp_share(const gw_light_push *push, gw_vec3 g, gw_vec3 *towards, float *distance);

/* Aims the s-th ray, of push->samples, at a place of the disc that the light shows.
 *   turn       by how much the places are turned, in turns
 *   towards    its middle, at that distance
 *   ray        receives direction and t_max */
void gw_lamp_aim(const gw_light_push *push, uint32_t s, float turn, gw_vec3 towards, float distance,
				 gw_ray *ray);

#endif
