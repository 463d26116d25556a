/*
 * surface_holes.h - holes in the surface of points, where no scanner is known that would say what
 * is a hole. Internal to lib/.
 *
 * From places in the free space between surfaces it is looked all around, through a grid of cells
 * that discs touch. Where most directions meet something, and those that do not are a component
 * with surface all around it, that component is a hole, if its boundary is much smaller than what
 * is seen from there and lies about as far away on all sides. A membrane is put where the surface
 * would be: the inverse of the distance, which is harmonic for a plane, as the boundary has it.
 *
 * In the open, a boundary that jumps from what is near to what is far is that of no hole, as what
 * is far is seen through it: a door, and the ground behind it. In closed rooms the near part may be
 * furniture before a hole, or before its own shadow in the scan.
 *
 * So the front of an open box is no hole, as it is as large as the box; the sky over ground is
 * none, as it is not enclosed; a window is one, and nobody knows whether it is a window.
 */
#ifndef SURFACE_HOLES_H
#define SURFACE_HOLES_H

#include "surfels/scanned_space.h"

/*
 * Finds the holes, and marks in a grid where they are.
 * Where there are some, it also marks what is solid (solid_cells.h).
 *   space   empty; on success to be cleared by the caller, and empty where there is no hole
 * The result does not depend on threads. GW_ERROR_MEMORY.
 */
gw_status gw_surface_holes_find(const gw_surfels *surfels, uint32_t threads,
								gw_scanned_space *space, gw_error *error);

#endif
