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

#include "octree/octree_bindings.h"
#include "light/transport_layout.h"

/* Texels a side of what is in memory at once, without borders. */
#define GW_SHADOW_WINDOW 2048u

/*
 * Fills the share of one light that each surfel sees.
 *   surfels      gives the bounds of the cloud
 *   light        the light in grid coordinates
 *   size         texels a side of a map, at least 1
 *   visibility   storage buffer, surfel count floats; receives 0..1, and 0 outside a spot's map
 * Fails with GW_ERROR_MEMORY or what gw_pass_run says. Nothing stays allocated.
 */
gw_status gw_shadow_map_visibility(gw_passes *passes, const gw_octree *octree,
								   const gw_surfels *surfels, const gw_light_push *light,
								   uint32_t size, gw_buffer *visibility, gw_error *error);

#endif
