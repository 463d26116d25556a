/*
 * voxel_merge.h - the voxels of a bake in larger cells.
 */
#ifndef VOXEL_MERGE_H
#define VOXEL_MERGE_H

#include "glowworm.h"

/*
 * Puts each voxel into the cell of the new size that its centre lies in. What a wall covers stays:
 * a cell's density is the sum of the voxels' densities times their share of a cell's side, at most
 * 1. Radiance, albedo, emission and normal are means weighted by density (evenly where all are 0).
 * Cells come in ascending order of z, y, x.
 *   size     metres, at least voxels->size, and so large that 2^20 cells reach over all
 *   merged   on success owned by the caller, freed with voxel_merge_clear; empty on failure
 *   error    GW_ERROR_USAGE for a size out of range, GW_ERROR_MEMORY
 */
gw_status voxel_merge(const gw_voxels *voxels, double size, gw_voxels *merged, gw_error *error);
void voxel_merge_clear(gw_voxels *merged);

#endif
