/*
 * propagation.h - trace step of a light propagation volume (Kaplanyan and Dachsbacher 2010,
 * Cascaded Light Propagation Volumes for Real-Time Indirect Illumination) in the cells of a uniform
 * grid: surface sends its flux into the cells before it, and from there light goes from cell to
 * cell, step by step, until hardly any is left that moves. No rays are traced but those that say
 * which cells see each other.
 *
 * What a cell sends to the next one goes on as a cosine lobe along the face that they share; the
 * paper has five lobes, of the faces beyond (volume_spread.comp says why).
 *
 * Where the paper keeps intensities, cells keep the radiance that arrives at their centres, as
 * those of radiance_volume.h do: the flux that got in over pi times the area through which it came,
 * which is that of the open faces and of the surface that sends into the cell. So a cell into which
 * all send the same radiance has that, wherever a wall cuts it; and of its light the same shares as
 * came through faces and from surface go on through faces and end on surface.
 */
#ifndef PROPAGATION_H
#define PROPAGATION_H

#include "light/radiance_volume.h"

/* Once less of what was sent still moves, no more steps are made. */
#define GW_PROPAGATION_REST 0.002

typedef struct gw_propagation {
	gw_buffer face_cell;   /* R32_UINT, GW_CELL_FACES a cell: its neighbours, or GW_NONE */
	gw_buffer face_share;  /* R32_SFLOAT, likewise: volume_spread.comp */
	gw_buffer list_first;  /* R32_UINT, a cell and the end: what sends light into it */
	gw_buffer list_facet;  /* R32_UINT: facets, + GW_SENDS_BACK */
	gw_buffer list_weight; /* R32_SFLOAT: volume_inject.comp */
	gw_buffer sky;         /* R32G32B32A32_SFLOAT, a cell: harmonics of a sky of radiance 1 */
	gw_buffer moving[2];   /* as gw_radiance_volume.radiance: light under way, this step and next */
	const gw_buffer *plane; /* of the facets; the octree's */
	float *entry;           /* a cell: area through which light gets in, in faces */
	uint32_t longest;       /* list */
	uint32_t steps;         /* that the latest light took */
} gw_propagation;

/*
 * Finds out what sends light into which cell, and which cells see each other.
 *   volume   of order 2, with all cells in free space
 *   p        on success to be destroyed by the caller; empty on failure
 */
gw_status gw_propagation_make(const gw_record_context *on, const gw_radiance_volume *volume,
							  gw_propagation *p, gw_error *error);
void gw_propagation_destroy(gw_gpu *gpu, gw_propagation *p); /* an empty one is fine */

/* Fills volume->radiance with light of surface and an even sky; of maps it knows nothing. */
gw_status gw_propagation_fill(gw_passes *passes, gw_radiance_volume *volume, gw_propagation *p,
							  const gw_volume_light *light, gw_error *error);

#endif
