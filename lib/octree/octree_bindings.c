/*
 * octree_bindings.c - see octree_bindings.h.
 */
#include "octree/octree_bindings.h"

#include <string.h>

/* How far a leaf's plane reaches beyond its cell, in cells, to close the cracks between neighbours.
 * Of the rays inside a sphere 30 cells wide 0.19 % escape at 0.02, 0.08 % at 0.1; from 0.2 on,
 * planes that stick out over edges cost more light than cracks do. */
#define PLANE_OVERLAP 0.1f

enum { DEPTH, DIRECTORY_LEVEL, OVERLAP, HAS_LARGE_DISCS, DARK_FACET };

void gw_octree_passes(gw_passes *passes, gw_gpu *gpu, const gw_octree *octree)
{
	const float overlap = PLANE_OVERLAP;
	*passes = (gw_passes){ .gpu = gpu,
						   .constant = { [DEPTH] = octree->depth,
										 [DIRECTORY_LEVEL] = octree->directory_level,
										 [HAS_LARGE_DISCS] = octree->tree_discs > 0,
										 [DARK_FACET] = octree->dark_facet } };
	memcpy(&passes->constant[OVERLAP], &overlap, sizeof overlap);
}

bool gw_octree_passes_fit(const gw_passes *passes, const gw_octree *octree)
{
	return passes->constant[HAS_LARGE_DISCS] == (octree->tree_discs > 0) &&
		   passes->constant[DARK_FACET] == octree->dark_facet;
}
