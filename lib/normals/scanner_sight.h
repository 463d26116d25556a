/*
 * scanner_sight.h - which of several scanners see a surfel, where nobody knows which of them took
 * its points. Internal to lib/.
 *
 * The surface is stood for by a coarse grid: each cell that holds surfels has one plane, through
 * their middle, and a scanner is in sight when the straight way to it crosses no such plane within
 * its cell. What crosses within half a cell of the surfel's own plane is its own surface.
 */
#ifndef SCANNER_SIGHT_H
#define SCANNER_SIGHT_H

#include "cloud/neighbours.h"

/* Where scanners stand, and planes that are known before their side is. */
typedef struct gw_scanner_places {
	const double *position; /* 3 * count, metres, as surfels->position */
	size_t count;
	const float *plane; /* 4 a surfel: normal of either sign, and anything */
} gw_scanner_places;

/* Ways to scanners that are followed, about. */
#define GW_SIGHTS 4000000u

/* Of more scanners than that one in so many is asked. */
#define GW_SIGHT_SCANNERS 64u
static inline size_t gw_sight_step(size_t scanners)
{
	return scanners > GW_SIGHT_SCANNERS ? (scanners + GW_SIGHT_SCANNERS - 1) / GW_SIGHT_SCANNERS
										: 1;
}

/*
 * Finds the scanners that have a surfel's front in sight, or either side of what is lit on both. Of
 * many surfels some are looked at alone, one in so many that GW_SIGHTS ways are followed.
 *   places   with the surfels' normals as planes
 *   options  its threads, and what asks whether to stop
 *   seen_by  surfels->count, zeros; receives bits, of which bit i stands for scanner
 *            i * gw_sight_step(places->count)
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED. The result does not depend on threads.
 */
gw_status gw_scanners_see(gw_neighbours *search, const gw_surfels *surfels,
						  const gw_scanner_places *places, const gw_surfels_options *options,
						  uint64_t *seen_by, gw_error *error);

/*
 * What share of the ways from places on the surface leaves the scene without crossing it, on the
 * side of the normals and on the other one.
 *   places   planes alone: count is 0
 *   share    receives both, 0 to 1
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_sight_open_share(gw_neighbours *search, const gw_surfels *surfels,
							  const gw_scanner_places *places, double share[2], gw_error *error);

#endif
