/*
 * solid_cells.h - what is solid between the surfaces of points, where no scanner is known that saw
 * what is free. Internal to lib/.
 *
 * Behind a point, away from its normal, something solid begins, and it ends at the next surface. If
 * that surface, too, shows its back, solid it is. One that was not scanned all around, as a box
 * whose lid nobody saw, is open to light that never was there.
 */
#ifndef SOLID_CELLS_H
#define SOLID_CELLS_H

#include "surfels/scanned_space.h"

/*
 * Marks cells of a grid whose surfaces are marked already: those behind surfaces that face opposite
 * ways. Only GW_SPACE_FREE becomes GW_SPACE_SOLID. GW_ERROR_MEMORY.
 */
gw_status gw_solid_cells_mark(const gw_surfels *surfels, gw_scanned_space *space, gw_error *error);

#endif
