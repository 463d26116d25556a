/*
 * shadow_map.h - which share of a light each surfel sees, by shadow maps (Salm 2.3, 4.2) instead
 * of by shadow rays. What light_visibility.comp finds by tracing is found here by drawing the
 * planes in the leaves as the light sees them and comparing depths.
 *
 * A spot light narrower than 80 degrees from its axis has one perspective map, as has a lamp that
 * sees the cloud from outside; other lamps have the six faces of a cube, and a sun has one
 * orthographic map over the cloud. A map is drawn in windows of at most GW_SHADOW_WINDOW texels a
 * side, one after the other, so that memory does not grow with its size. A light with an
 * extent gets the filter's penumbra of about 5 texels, not that of its extent.
 */
#ifndef SHADOW_MAP_H
#define SHADOW_MAP_H

#include "surfels/scanned_space.h"

#include "octree/octree_bindings.h"
#include "light/transport_layout.h"

/* Texels a side of what is in memory at once, without borders. */
#define GW_SHADOW_WINDOW 2048u

/* What lamps shine on, and how their light is found. */
typedef struct gw_lit_cloud {
	gw_passes *passes;
	const gw_octree *octree;   /* of these surfels */
	const gw_surfels *surfels; /* which give the local frame and the bounds */
	const gw_bake_options *options;
	const bool *lit;   /* NULL, or one a surfel: the others are left dark */
	const bool *asked; /* NULL, or one a surfel: what lamps give is that of these, and one that
						  gives these nothing may shine elsewhere */
	const gw_scanned_space *closed; /* NULL, or whose gaps hide lamps and suns (direct_light.h) */
} gw_lit_cloud;

/*
 * Fills the share of one light that each surfel sees.
 *   cloud        its options' shadow_map_size is at least 1
 *   light        the light in grid coordinates
 *   visibility   storage buffer, surfel count floats; receives 0..1, and 0 outside a spot's map
 * Fails with GW_ERROR_MEMORY or what gw_pass_run says. Nothing stays allocated.
 */
gw_status gw_shadow_map_visibility(const gw_lit_cloud *cloud, const gw_light_push *light,
								   gw_buffer *visibility, gw_error *error);

#endif
