/*
 * needed_facets.h - which facets the light of some surfels depends on, and how finely.
 *
 * Light of a part of a scene needs records of its own; what their rays hit has to be lit, and needs
 * records again, and so on: the dependency analysis of the point-based pipeline for environment
 * light (Harada), over nodes of the octree. A ray stands for all that lies around what it hit, so
 * the whole node is needed; of a node with surface to both sides of a wall only that which faces as
 * what was hit does, by the normal cone of the hits. The further a facet is from the part, counted
 * in reflections, the less its own detail matters, and the further apart its records may be.
 */
#ifndef NEEDED_FACETS_H
#define NEEDED_FACETS_H

#include "octree/octree.h"

typedef struct gw_needed_facets {
	size_t facets;
	float *centre, *plane; /* 4 * facets: as facet_centre and facet_plane of the octree */
	uint32_t *leaf;        /* facets: as facet_leaf */
	uint32_t *node;        /* of each leaf: which node of GW_NEEDED_NODE leaf cells each lies in */
	size_t nodes;
	float *spacing; /* facets: between records, leaf cells; INFINITY: not needed */
} gw_needed_facets;

/* Leaf cells a side of the nodes that are needed as a whole. */
#define GW_NEEDED_NODE 8u

/* None is needed yet. On success to be freed with gw_needed_facets_clear. */
gw_status gw_needed_facets_make(gw_gpu *gpu, const gw_octree *octree, gw_needed_facets *needed,
								gw_error *error);
void gw_needed_facets_clear(gw_needed_facets *needed);

/* How far what is needed around surfels reaches, and between their records, leaf cells. */
typedef struct gw_needed_reach {
	float reach, spacing;
} gw_needed_reach;

/*
 * Needs what lies around some surfels: all facets within reach of theirs, and some that are further
 * off by less than that.
 *   asked   surfel count
 */
gw_status gw_needed_facets_around(gw_gpu *gpu, const gw_octree *octree, const bool *asked,
								  const gw_needed_reach *how, gw_needed_facets *needed,
								  gw_error *error);

/*
 * Needs what rays hit.
 *   hit      `hits` facets, or GW_NONE
 *   spacing  between records there, leaf cells
 *   more     receives how many facets were not needed before
 */
gw_status gw_needed_facets_hit(const uint32_t *hit, size_t hits, float spacing,
							   gw_needed_facets *needed, size_t *more, gw_error *error);

/*
 * Facets that are mostly of some surfels are taken for none: what depends on them needs no records
 * there.
 *   known   surfels flags
 */
gw_status gw_needed_facets_leave_out(gw_gpu *gpu, const gw_octree *octree, const bool *known,
									 gw_needed_facets *needed, gw_error *error);

/*
 * What of the surfels lies in facets that are needed.
 *   facet   surfels numbers: receives the facet of which each has the most, GW_NONE where it has
 *           none that is needed
 */
gw_status gw_needed_facets_surfels(gw_gpu *gpu, const gw_octree *octree,
								   const gw_needed_facets *needed, size_t surfels, uint32_t *facet,
								   gw_error *error);

#endif
