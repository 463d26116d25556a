/*
 * shells.h - which pieces of surface have others within them. Internal to lib/.
 *
 * Nobody scans things inside of a closed thing. So where others lie within the space that a piece
 * encloses on one of its sides, that side is its front: it is a room, and they are what stands in
 * it. They lie there if most of what they see from their own front is that side, and not from as
 * near as another layer of the same surface would be.
 */
#ifndef SHELLS_H
#define SHELLS_H

#include "normals/side_light.h"

#include <stdbool.h>

/* Pieces of surface, made of patches. */
typedef struct gw_pieces {
	size_t count;             /* of patches; numbers of pieces are below it */
	const uint32_t *piece_of; /* a patch's */
	const int8_t *sign;       /* a patch's: 1 where its normals point to the front, else -1 */
	const double *area;       /* a piece's, m^2: that its places stand for */
} gw_pieces;

/*
 * Finds on which side of pieces others lie within them.
 *   sights   sight_count, from either side of the patches
 *   holds    pieces->count; receives 1 where they lie before a piece's front, -1 behind its back,
 *            and 0 where none do, or too few
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_find_shells(const gw_pieces *pieces, const gw_side_sight *sights, size_t sight_count,
						 int8_t *holds, gw_error *error);

#endif
