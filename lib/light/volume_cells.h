/*
 * volume_cells.h - which cells of a radiance volume have light: where they lie, and what reads
 * them.
 */
#ifndef VOLUME_CELLS_H
#define VOLUME_CELLS_H

#include "light/radiance_volume.h"

/* Lays the grid over the bounds of the surfels: volume->minimum, size and cells. Fails with
 * GW_ERROR_MEMORY where a texel buffer cannot hold a number for each cell. */
gw_status gw_volume_lay_out(const gw_record_context *on, const gw_volume_wish *wish,
							gw_radiance_volume *volume, gw_error *error);

/* Lists the cells that are asked for, buried or not: volume->cell and count. */
gw_status gw_volume_list_cells(const gw_record_context *on, const gw_volume_wish *wish,
							   gw_radiance_volume *volume, gw_error *error);

/* Grid coordinates of the centre of a cell, by its place in the grid. */
void gw_volume_centre(const gw_radiance_volume *volume, uint32_t cell, float centre[3]);

#endif
