/*
 * side_pieces.h - which points lie on one smooth piece of surface.
 *
 * A floor, a wall, a thing without edges: from neighbour to neighbour on the same smooth surface.
 * Sides of a piece are right or wrong together, so what rays say of some points of it holds for the
 * others: those of a floor that see into a thing whose underside nobody scanned are no worse than
 * the rest of the floor.
 */
#ifndef SIDE_PIECES_H
#define SIDE_PIECES_H

#include "cloud/surfels.h"

/*
 * Numbers the pieces.
 *   threads   of the host; 0: one a core
 *   piece     surfels->count, receives numbers below that count, the same for surfels of one piece
 * The result does not depend on threads. Fails with GW_ERROR_MEMORY.
 */
gw_status gw_side_pieces_find(const gw_surfels *surfels, uint32_t threads, uint32_t *piece,
							  gw_error *error);

#endif
