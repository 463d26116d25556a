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

/*
 * Finds the scanners that have a surfel's front in sight, or either side of what is lit on both. Of
 * many surfels some are looked at alone, evenly, GW_SIGHTS for all scanners together.
 *   places   with the surfels' normals as planes
 *   options  its threads, and what asks whether to stop
 *   seen_by  gw_seen_by_words(places) * surfels->count, zeros; receives bits: of word k of a surfel
 *            bit i stands for scanner 64 k + i
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED. The result does not depend on threads.
 */
#define GW_SIGHTS 4000000u
gw_status gw_scanners_see(gw_neighbours *search, const gw_surfels *surfels,
						  const gw_scanner_places *places, const gw_surfels_options *options,
						  uint64_t *seen_by, gw_error *error);

/* Words that the scanners take of each surfel. */
static inline size_t gw_seen_by_words(const gw_scanner_places *places)
{
	return (places->count + 63) / 64;
}

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
