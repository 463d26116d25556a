/*
 * plane_error.h - how far off normals are that were estimated from the points' places.
 *
 * Such a normal is that of a plane through many neighbours, so it turns where the surface bends
 * sharply, at creases, long before they are reached. How much shows in the heights of neighbours
 * over the surface that the normals tell of: their squares grow with the squared distance, from
 * what is noise of the places. Noise turns the plane itself besides, by its variance over the
 * plane's moment of inertia. And of a surfel that lies no further from another face of a crease
 * than noise moves it, it is not known whose normal it has.
 */
#ifndef PLANE_ERROR_H
#define PLANE_ERROR_H

#include "normals/normal_noise.h"

/*
 * Replaces what is above 0 in shading_normal_off by the RMS angle by which the normals there are
 * off, radians: one value for GW_NOISE_REGION surfels. search   of the surfels at their given
 * positions Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_plane_error(gw_neighbours *search, gw_surfels *surfels, gw_error *error);

#endif
