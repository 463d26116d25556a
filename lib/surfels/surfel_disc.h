/* surfel_disc.h - the piece of surface that each point stands for. Internal to lib/. */
#ifndef SURFEL_DISC_H
#define SURFEL_DISC_H

#include "cloud/neighbours.h"
#include "surfels/filled_space.h"

/*
 * Fills nearest, radius, area, clip, bend, creased, spacing and given_area, noise unless it is
 * there, and sets two_sided of surfels that have fewer than three neighbours on their surface.
 *   lone        as gw_filled_space_find finds them
 *   rough_area  as in gw_surfels_options
 *   gap         NULL or count floats that receive the Euclidean distance to the nearest other one
 */
gw_status gw_discs_make(gw_neighbours *search, const gw_lone_points *lone, gw_surfels *surfels,
						bool rough_area, float *gap, gw_error *error);

/*
 * Makes discs narrower that are wider than their neighbours' allow; part of gw_discs_make, see
 * disc_width.c. Changes radius and area.
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_disc_widths_bound(gw_neighbours *search, gw_surfels *surfels, bool rough_area,
							   gw_error *error);

/*
 * Settles where surfaces end that border on nothing: replaces the clips of discs near such
 * boundaries, and forgets boundaries that few surfels see. Part of gw_discs_make; see
 * surfel_boundaries.c.
 *   surfels    with all that gw_discs_make fills per surfel; clip, area and creased may change
 *   boundary   count, a bit for each clip of a surfel that was taken for a boundary
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_boundaries_settle(gw_neighbours *search, gw_surfels *surfels, bool rough_area,
							   const uint8_t *boundary, gw_error *error);

#endif
