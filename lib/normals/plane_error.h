/*
 * plane_error.h - how far off normals are that were estimated from the points' places.
 *
 * Such a normal is that of a plane through many neighbours, so it turns where the surface bends
 * sharply, at creases, long before they are reached. How much shows in the heights of neighbours
 * over the surface that the normals tell of: their squares grow with the squared distance, from
 * what is noise of the places. Noise turns the plane itself besides, by its variance over the
 * plane's moment of inertia. And of a surfel that lies no further from another face of a crease
 * than noise moves it, it is not known whose normal it has. Where a plane was fitted over a crease,
 * the surfel lies in the planes of neighbours whose normals are others: what they differ, beyond
 * what a bend of the surface makes of it, is how far off its own may be.
 */
#ifndef PLANE_ERROR_H
#define PLANE_ERROR_H

#include "normals/normal_noise.h"

/* What shading_normal_off holds of a normal whose error is to be found: of a plane through
 * neighbours, or through neighbours in the rows and columns of a scan. */
#define GW_PLANE_BY_PLACE 1.0f
#define GW_PLANE_BY_GRID 0.5f

/*
 * Replaces what is above 0 in shading_normal_off, one of these, by the RMS angle by which the
 * normal there is off, radians. search   of the surfels at their given positions Fails with
 * GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_plane_error(gw_neighbours *search, gw_surfels *surfels, gw_error *error);

#endif
