/*
 * shared_rays.h - what records see by the rays of their neighbours beside their own: as if each had
 * several times as many, for what it takes to reckon their light once more.
 *
 * The noise of its rays is most of what a record is off, and neighbours see about the same, from
 * other places and with other normals, which is taken into account; not whether something hides it
 * from one of them alone. record_share.comp says how.
 */
#ifndef SHARED_RAYS_H
#define SHARED_RAYS_H

#include "light/gather_rays.h"

/* More rays than this are not shared: what is hidden from one record alone weighs more than their
 * noise: of a rough cave of 100,000 points indirect light is an eighth less off with 64 rays that
 * are shared, as far off with 128, and a twentieth more with 256. */
#define GW_SHARED_RAYS_MOST 128u

/* What is shared. */
typedef struct gw_shared_rays {
	const gw_record_context *on; /* records that have the weights of their facets */
	const gw_ray_gather *gather;
	const gw_sampled_sources *sky;   /* of which records->first has the sky, as far as rays see it;
										it stays as it is where portals are sampled */
	const gw_buffer *facet_radiance; /* NULL, or of which records->indirect has what rays hit, vec4
										a facet */
	bool moments;                    /* their moments as well */
} gw_shared_rays;

/* Changes records->first and records->indirect, and their moments, from what their own rays see to
 * what those of all around do. Nothing happens where there are more than GW_SHARED_RAYS_MOST. */
gw_status gw_shared_rays_see(const gw_shared_rays *task, gw_error *error);

#endif
