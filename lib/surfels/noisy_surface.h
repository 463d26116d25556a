/*
 * noisy_surface.h - points that noise has spread across their surface by as much as they are apart
 * and more, as those of scanners that are carried along. Internal to lib/.
 *
 * A plane through a dozen neighbours then goes anywhere, and joining neighbours does not help: they
 * are as often above each other as beside. But planes through all that is around within some five
 * standard deviations of the noise lie within a small part of it, and points are put onto these.
 * What is finer nobody knows. What fills space, as leaves do, or stands above the ground is thicker
 * the wider one looks, and stays.
 */
#ifndef NOISY_SURFACE_H
#define NOISY_SURFACE_H

#include "cloud/neighbours.h"

/*
 * Puts points onto the surface that they lie around, where noise is large for their distances.
 *   surfels   of the points, with what gw_frame_make fills
 *   search    of these surfels
 *   threads   0 means one a processor
 *   position  3 a point, what the surfels were made of; is changed where points are moved
 *   moved     receives how many surfels were: 0 where noise is small, or there is no surface
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_noisy_surface_flatten(const gw_surfels *surfels, gw_neighbours *search,
								   uint32_t threads, double *position, size_t *moved,
								   gw_error *error);

#endif
