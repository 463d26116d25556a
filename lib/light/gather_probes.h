/*
 * gather_probes.h - trace step by placed probes (Wang 2018): the rays of records are followed
 * through the maps of probes instead of through the octree. What a texel shows is a facet, whose
 * radiance is the radiance in the probe; so the hits serve every bounce and every lighting, as
 * those of gather_rays.h do.
 */
#ifndef GATHER_PROBES_H
#define GATHER_PROBES_H

#include "glowworm_probes.h"
#include "light/gather_rays.h"

/* Probes by whose maps rays are followed; all in grid coordinates and leaf cells in place of
 * metres. */
typedef struct gw_probe_maps {
	gw_probes *probes; /* owned */
	uint32_t *facet;   /* of each texel of all maps, GW_NONE for none; owned */
} gw_probe_maps;

/*
 * Follows `rays` rays from every record.
 *   on        its passes' threads work; the hits do not depend on how many
 *   gather    on success the caller's, as of gw_ray_gather_trace
 */
gw_status gw_probe_gather_trace(const gw_record_context *on, const gw_probe_maps *maps,
								uint32_t rays, uint32_t seed, gw_ray_gather *gather,
								gw_error *error);
void gw_probe_maps_clear(gw_probe_maps *maps);

#endif
