/*
 * probe_cells.h - which probes serve each place of free space (Wang 2018, section 4.2).
 */
#ifndef PROBE_CELLS_H
#define PROBE_CELLS_H

#include "glowworm_probes.h"

/*
 * Finds the best probes of each cell, by their maps of distances.
 *   probes    traced, with bounds; receives probes->cells, freed with gw_probe_cells_clear
 *   threads   0: one a processor
 * Fails with GW_ERROR_MEMORY. The result does not depend on the number of threads.
 */
gw_status gw_probe_cells_find(gw_probes *probes, uint32_t threads, gw_error *error);
void gw_probe_cells_clear(gw_probe_cells *cells);

#endif
