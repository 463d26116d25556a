/*
 * probe_sight.h - which places on the surface probes see, and how well: what the thesis of Wang
 * (2018, section 3.2.1) calls the visibility atlas. Instead of texels of an unfolded mesh it has
 * places that stand for equal areas of the octree's facets.
 */
#ifndef PROBE_SIGHT_H
#define PROBE_SIGHT_H

#include "octree/octree_bindings.h"

/* Shares of the cosine and of the distance in how well a place is seen: w1 and w2 of equation 3.2.
 * Together 1, so that no place is seen better than that. */
#define GW_SIGHT_ORIENTATION 0.5f
#define GW_SIGHT_DISTANCE 0.5f

typedef struct gw_sight_places {
	uint32_t count;
	float *area;                /* leaf cells^2, that each stands for; count */
	double total;               /* all of them together */
	float reach;                /* leaf cells: a place is seen best from so far away and further */
	gw_buffer position, normal; /* texel buffers, vec4 a place: see probe_sight.comp */
} gw_sight_places;

/*
 * Chooses places: every facet where there are no more than `most`, else facets in the order of the
 * octree at equal steps of area, so that all stand for as much.
 *   most     at least 1
 *   shift    in [0, 1): where in a step the first one lies, so that there are other choices
 *   places   on success to be cleared with gw_sight_places_clear; empty on failure
 */
gw_status gw_sight_places_make(gw_gpu *gpu, const gw_octree *octree, uint32_t most, double shift,
							   gw_sight_places *places, gw_error *error);
void gw_sight_places_clear(gw_gpu *gpu, gw_sight_places *places);

/* What traces: the passes of an octree. */
typedef struct gw_sight {
	gw_passes *passes;
	const gw_octree *octree;
	const gw_sight_places *places;
} gw_sight;

/*
 * Looks from viewers at all places.
 *   viewer   4 * count: grid coordinates, and 0
 *   value    receives count * places->count: 0 where a viewer does not see a place, else above 0
 *            and at most 1
 */
gw_status gw_sight_look(const gw_sight *sight, const float *viewer, size_t count, float *value,
						gw_error *error);

#endif
