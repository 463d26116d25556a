/*
 * portals.h - portals through which the sky shines into a scene: the hole in a roof, the
 * mouth of a cave.
 *
 * Few of a record's rays find such a portal, so that what comes through is noisy. But the rays of
 * all records know where it is: they cross there. The portals found are spheres that records draw
 * further directions to, beside their rays (gather_rays.h); both are combined by multiple
 * importance sampling (Veach 1997, chapter 9), so that spheres in wrong places cost time but no
 * light.
 */
#ifndef PORTALS_H
#define PORTALS_H

#include "light/records.h"

struct gw_ray_gather;

/* All zero: not looked for. */
typedef struct gw_portals {
	uint32_t looked;  /* 1: they have been looked for */
	uint32_t count;   /* 0: there are none, or the scene is too open to need them */
	float escaped;    /* share of all rays that left the scene */
	gw_buffer sphere; /* R32G32B32A32_SFLOAT, count: centre in grid coordinates, radius */
} gw_portals;

/* Portals, at most: records weigh all of them for each of their samples. */
#define GW_PORTALS_MOST 64u

/*
 * Looks for portals among the rays that left the scene.
 *   gather     the hits of the records
 *   portals   receives them; on success to be freed with gw_portals_destroy
 * GW_ERROR_MEMORY and failures of the device.
 */
gw_status gw_portals_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						  const struct gw_ray_gather *gather, gw_portals *portals, gw_error *error);
void gw_portals_destroy(gw_gpu *gpu, gw_portals *portals);

#endif
