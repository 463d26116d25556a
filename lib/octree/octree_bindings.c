/*
 * octree_bindings.c - see octree_bindings.h.
 */
#include "octree/octree_bindings.h"

#include <string.h>

/* How far a leaf's plane reaches beyond its cell, in cells, to close the cracks between neighbours.
 * Of the rays inside a sphere 30 cells wide 0.19 % escape at 0.02, 0.08 % at 0.1; from 0.2 on,
 * planes that stick out over edges cost more light than cracks do. */
#define CELL_SLACK 0.1f

enum { DEPTH, DIRECTORY_LEVEL, SLACK, HAS_LARGE_DISCS };

void gw_octree_passes(gw_passes *passes, gw_gpu *gpu, const gw_octree *octree)
{
	const float slack = CELL_SLACK;
	*passes = (gw_passes){ .gpu = gpu,
						   .constant = { [DEPTH] = octree->depth,
										 [DIRECTORY_LEVEL] = octree->directory_level,
										 [HAS_LARGE_DISCS] = octree->tree_discs > 0 } };
	memcpy(&passes->constant[SLACK], &slack, sizeof slack);
}

bool gw_octree_passes_fit(const gw_passes *passes, const gw_octree *octree)
{
	return passes->constant[HAS_LARGE_DISCS] == (octree->tree_discs > 0);
}

/* A tree of n discs has 2 n - 1 nodes, as its first word says. */
static uint32_t discs_of(const gw_passes *passes, const gw_binding *tree)
{
	if (!passes->constant[HAS_LARGE_DISCS] || tree == NULL)
		return 0;
	const uint32_t *nodes = tree->buffer->mapped;
	return (*nodes + 1) / 2;
}

gw_octree gw_octree_of_bindings(const gw_passes *passes, const gw_binding *trace,
								const gw_binding *discs, const gw_binding *tree)
{
	gw_octree octree = { .depth = passes->constant[DEPTH],
						 .directory_level = passes->constant[DIRECTORY_LEVEL],
						 .tree_discs = discs_of(passes, tree),
						 .ray_directory = *trace[0].buffer,
						 .node = *trace[1].buffer,
						 .leaf_tile = *trace[2].buffer,
						 .lobe_plane = *trace[3].buffer,
						 .lobe_centre = *trace[4].buffer };
	if (discs != NULL) {
		octree.leaf_fragment = *discs[0].buffer;
		octree.fragment_surfel = *discs[1].buffer;
		octree.surfel_position = *discs[2].buffer;
		octree.surfel_normal = *discs[3].buffer;
		octree.surfel_disc = *discs[4].buffer;
		octree.surfel_clip = *discs[5].buffer;
	}
	if (tree != NULL)
		octree.disc_tree = *tree->buffer;
	return octree;
}
