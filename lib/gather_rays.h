/*
 * gather_rays.h - trace step by rays (Salm 4.4.3, the ray-based variant on the leaf level): each
 * record sends rays against the planes in the leaves once; the hits stay and every bounce is a
 * sparse product over them.
 */
#ifndef GATHER_RAYS_H
#define GATHER_RAYS_H

#include "emitters.h"
#include "records.h"

typedef struct gw_ray_gather {
	uint32_t rays; /* a record */
	uint32_t seed;
	gw_buffer lobe;     /* R32_UINT, rays * records: what each ray hit, GW_NONE for nothing */
	gw_buffer distance; /* R32_SFLOAT, likewise, leaf cells */
} gw_ray_gather;

/* Traces `rays` rays from every record. */
gw_status gw_ray_gather_trace(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							  uint32_t rays, uint32_t seed, gw_ray_gather *gather, gw_error *error);
void gw_ray_gather_destroy(gw_gpu *gpu, gw_ray_gather *gather);

/*
 * Irradiance that reaches the records unreflected, into records->first; also the distance to the
 * nearest thing each saw, into position w.
 *   emitters   sampled with light_samples points each; those that the rays hit count as well when
 *              use_hits, combined by multiple importance sampling. light_samples 0: only hits count
 *   sky        radiance seen by rays that leave the scene
 */
gw_status gw_ray_gather_first(gw_passes *passes, const gw_octree *octree, gw_records *records,
							  const gw_ray_gather *gather, const gw_emitters *emitters,
							  uint32_t light_samples, bool use_hits, const float sky[3],
							  gw_error *error);

/* One bounce: irradiance from what the rays hit, into records->gathered. */
gw_status gw_ray_gather_bounce(gw_passes *passes, const gw_ray_gather *gather,
							   const gw_buffer *lobe_radiance, gw_records *records,
							   gw_error *error);

#endif
