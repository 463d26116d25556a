/*
 * surfel_crease.h - where the plane of a surfel meets other surfaces. Internal to lib/.
 * Thread-safe.
 */
#ifndef SURFEL_CREASE_H
#define SURFEL_CREASE_H

#include "surfels/surfel_plane.h"

/* Most width of a void behind which a crease is looked for, of the reach of the neighbours. */
#define GW_VOID_WIDTH 1.8

/*
 * At most two creases, the nearest ones on which enough neighbours on other surfaces agree.
 *   list    neighbours on any surface
 *   reach   of those on the surfel's own, metres
 *   edge    receives half-planes that end at them; how many is returned
 */
uint32_t gw_creases_find(const gw_surfels *surfels, size_t surfel, const gw_neighbour_list *list,
						 double reach, gw_half_plane edge[2]);

/*
 * Does the surface end where it meets another one behind a void?
 *   list    what lies around the void
 *   edge    beyond which there are no points of the surface; receives the crease if there is one
 *   reach   of the surfel's neighbours on the surface, metres
 */
bool gw_plane_meets_crease(const gw_surfels *surfels, size_t surfel, const gw_neighbour_list *list,
						   gw_half_plane *edge, double reach);

#endif
