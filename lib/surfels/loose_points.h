/*
 * loose_points.h - points of leaves, twigs and wires that are about as far apart as these are wide.
 * Internal to lib/.
 *
 * Most of the neighbours of such a point lie on other leaves, and the few that face as it does on
 * several: a disc that reached to them would be a plate in the air, wider than the leaf. Nothing
 * around says how wide that is. But beams meet leaves as often as they meet walls, so a point on a
 * leaf stands for as much area as one on the solid surface near it. So does one on a wire across
 * which others run, or that floats before a wall, if its disc is wide for that surface; that
 * becomes as wide as those of even points there. One that is far from all that is solid around it,
 * as those of the rows in the air that beams leave which an edge has split, is as one on a leaf.
 */
#ifndef LOOSE_POINTS_H
#define LOOSE_POINTS_H

#include "cloud/neighbours.h"

/*
 * Makes the discs of loose points as small as what a point stands for on the nearest surface that
 * is none of leaves. Those that are smaller stay as they are, as do those that emit, whose power is
 * their area's.
 *   fixed     count, 1: the disc's size is known otherwise
 *   surfels   with discs; radius and area may change
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_loose_points_bound(gw_neighbours *search, const uint8_t *fixed, gw_surfels *surfels,
								gw_error *error);

#endif
