/*
 * record_places.h - where records go: dart throwing over the facets, on the CPU.
 */
#ifndef RECORD_PLACES_H
#define RECORD_PLACES_H

#include "glowworm.h"

/* Facets in the random order in which records are tried on them. */
typedef struct gw_dart_order {
	struct gw_dart *dart; /* owned */
	size_t count;
} gw_dart_order;

typedef struct gw_place_task {
	const float *centre, *plane; /* 4 * facets, as gw_octree.facet_centre and facet_plane; facets of
									area 0 are skipped */
	size_t facets;
	const float *albedo; /* NULL, or 4 * facets, as facet_albedo: what may face either way gets
							records on both sides */
	float spacing;       /* leaf cells; 0 chooses every facet */
	float radius;        /* of influence, leaf cells: how far off a facet's plane counts as another
							surface */
	const float *closer; /* NULL, or one a facet: its own spacing, at most the spacing, which has to
							be above 0; the radius shrinks with it. INFINITY: it needs none */
	const uint32_t *kept; /* kept_count facets that have records already */
	size_t kept_count;
	const gw_dart_order *order; /* of such a task with any spacing above 0, or NULL */
	size_t most;                /* 0, or to stop as soon as more than so many are chosen */
	uint64_t seed;
} gw_place_task;

/*
 * Lists facets in their order, once for several spacings.
 *   order   on success to be cleared by the caller; empty on failure
 */
gw_status gw_dart_order_make(const gw_place_task *task, gw_dart_order *order, gw_error *error);
void gw_dart_order_clear(gw_dart_order *order);

/*
 * Chooses facets for records, see gw_records_place.
 *   chosen   receives the facets, those of backs plus GW_RECORD_BACK, allocated: those that are
 * kept as they are, then the others in ascending order; freed by the caller
 */
gw_status gw_place_records(const gw_place_task *task, uint32_t **chosen, size_t *count,
						   gw_error *error);

#endif
