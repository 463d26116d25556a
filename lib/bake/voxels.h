/*
 * voxels.h - the octree's leaves with their light, as plain arrays.
 */
#ifndef VOXELS_H
#define VOXELS_H

#include "light/records.h"

typedef struct gw_voxels_task {
	gw_passes *passes;
	const gw_octree *octree;
	const gw_surfels *surfels;
	gw_records *records; /* NULL when nothing was gathered; its indirect becomes the sum of all
							gathered irradiance */
	const gw_buffer *facet_direct; /* irradiance from lamps; none where no lamp shines */
} gw_voxels_task;

/* Reads the leaves back. On success *voxels is owned by the caller, freed with gw_voxels_clear. */
gw_status gw_voxels_collect(const gw_voxels_task *task, gw_voxels *voxels, gw_error *error);
void gw_voxels_clear(gw_voxels *voxels);

#endif
