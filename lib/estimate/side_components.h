/*
 * side_components.h - which points lie on one smooth component of surface.
 *
 * A floor, a wall, a thing without edges: from neighbour to neighbour on the same smooth surface.
 * Sides of a component are right or wrong together, so what rays say of some points of it holds for
 * the others: those of a floor that see into a thing whose underside nobody scanned are no worse
 * than the rest of the floor.
 */
#ifndef SIDE_COMPONENTS_H
#define SIDE_COMPONENTS_H

#include "cloud/surfels.h"

/*
 * Numbers the components. The result does not depend on threads. Fails with GW_ERROR_MEMORY.
 *   threads     0: one a processor
 *   component   surfels->count, receives numbers below that count, the same for one component
 */
gw_status gw_side_components_find(const gw_surfels *surfels, uint32_t threads, uint32_t *component,
								  gw_error *error);

#endif
