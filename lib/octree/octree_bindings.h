/*
 * octree_bindings.h - what passes read of an octree, as bindings and specialisation constants.
 */
#ifndef OCTREE_BINDINGS_H
#define OCTREE_BINDINGS_H

#include "octree/octree.h"
#include "device/passes.h"

/* A set of passes for an octree of that shape; nothing is made yet. */
void gw_octree_passes(gw_passes *passes, gw_gpu *gpu, const gw_octree *octree);

/* Do passes that there are fit another octree of the same depth? */
bool gw_octree_passes_fit(const gw_passes *passes, const gw_octree *octree);

/* What octree_trace.glsl reads of an octree, and octree_discs.glsl, in the order of their lists. */
#define GW_TRACE_BINDINGS(octree)                                                                  \
	gw_whole(&(octree)->ray_directory), gw_whole(&(octree)->node), gw_whole(&(octree)->leaf_tile), \
		gw_whole(&(octree)->facet_plane), gw_whole(&(octree)->facet_centre)
#define GW_DISC_BINDINGS(octree)                                                                   \
	gw_whole(&(octree)->leaf_fragment), gw_whole(&(octree)->fragment_surfel),                      \
		gw_whole(&(octree)->surfel_position), gw_whole(&(octree)->surfel_normal),                  \
		gw_whole(&(octree)->surfel_disc), gw_whole(&(octree)->surfel_clip)
/* And disc_tree.glsl, which comes last. */
#define GW_TREE_BINDING(octree) gw_whole(&(octree)->disc_tree)
/* And opacity.glsl, after that. */
#define GW_OPACITY_BINDING(octree) gw_whole(&(octree)->facet_albedo)
/* And octree_discs.glsl once more, at the very end: which leaf a facet is of. */
#define GW_LEAF_BINDING(octree) gw_whole(&(octree)->facet_leaf)

#endif
