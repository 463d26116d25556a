/*
 * check_tree.h - discs of surfels in a tree of boxes, in which each node has four children, so that
 * a ray is held against four boxes at once. It is of places, normals and radii alone, whatever
 * octree there is and whatever shines, so that it is made once for many estimates.
 */
#ifndef CHECK_TREE_H
#define CHECK_TREE_H

#include "cloud/surfels.h"

#include <stdbool.h>

#define GW_CHECK_LEAF 0x80000000u
#define GW_CHECK_DISCS_MOST 0x0fffffffu

typedef float gw_check_lanes __attribute__((vector_size(16)));

/* Four boxes, and what is in each: a node, or GW_CHECK_LEAF, discs - 1 at bit 28, and the first. */
typedef struct gw_check_node {
	gw_check_lanes low[3], high[3];
	uint32_t child[4];
} gw_check_node;

/* All zero: it is not made. */
typedef struct gw_check_tree {
	uint32_t *surfel; /* one a disc, in the tree's order: the disc is that of the surfel */
	gw_check_node *node;
	uint32_t nodes; /* 0: the discs are so few that they need none */
	bool lent;      /* the arrays are somebody else's, and stay as they are */
} gw_check_tree;

/*
 * Makes the tree, unless it is made already.
 *   reach     radius of the discs, in that of the surfels
 *   threads   0 means one a processor
 *   tree      empty, or of the same surfels; to be cleared by the caller; on failure it is empty
 */
gw_status gw_check_tree_make(const gw_surfels *surfels, float reach, uint32_t threads,
							 gw_check_tree *tree, gw_error *error);

/* Nodes of the tree of so many discs: its shape follows from their number. */
size_t gw_check_tree_nodes(size_t count);

/* Whether a tree that was read is of that shape, so that every walk through it ends. */
bool gw_check_tree_fits(const gw_check_tree *tree, size_t count);

void gw_check_tree_clear(gw_check_tree *tree);

#endif
