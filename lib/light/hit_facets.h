/*
 * hit_facets.h - bounces from records to records on the processor, where facets can be left out.
 *
 * Only facets that rays hit matter to such a bounce, a third or a half of all. Work is cut into
 * pieces that do not depend on the number of threads, so neither do the results.
 */
#ifndef HIT_FACETS_H
#define HIT_FACETS_H

#include "light/gather_rays.h"

typedef struct gw_hit_facets {
	uint32_t *facet; /* count, ascending: facets that rays hit */
	size_t count;
} gw_hit_facets;

/* Lists them. On success the caller clears *hits; on failure it is empty. */
gw_status gw_hit_facets_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 const gw_ray_gather *gather, gw_hit_facets *hits, gw_error *error);
void gw_hit_facets_clear(gw_hit_facets *hits); /* an empty one is accepted */

/* Shades these facets alone with no direct light, as facet_shade.comp does; others keep what they
 * have. */
void gw_hit_facets_shade(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						 const gw_hit_facets *hits, gw_buffer *facet_radiance);

#endif
