/*
 * scanner_sight.h - which of several scanners saw a surfel, where nobody knows. Internal to lib/.
 *
 * The nearest scanner may stand behind a wall, or see a surface edge-on. Of those in sight, the one
 * whose points lie densest there counts: by the cosine over the square of the distance. A surface
 * is therefore stood for by a coarse grid: each cell that holds surfels has one plane, through
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
 * Finds a scanner for each surfel that has none: the one in sight that sees it most densely, or of
 * all of them when none is in sight, or when all of them are on the same side of the surfel's
 * plane, so that its side does not depend on which it was. scanner_of   surfels->count; what is
 * below places->count stays Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_scanners_assign(gw_neighbours *search, const gw_surfels *surfels,
							 const gw_scanner_places *places, uint32_t *scanner_of,
							 gw_error *error);

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
