/*
 * copc_tree.h - the octree of a COPC file: which points each node holds.
 *
 * A node of the octree holds one point of each cell that has any, of 128 cells along its side, the
 * one in the middle of the cell's points; its children hold the others. Ten thousand points are
 * a node at least, so that chunks are worth compressing: children that would get fewer are
 * none, and where few cells have points, more of each are taken. A node's points lie along a
 * Hilbert curve, and those of each short run of it by brightness, so that each is like the one
 * before. The same points give the same tree.
 */
#ifndef COPC_TREE_H
#define COPC_TREE_H

#include "las/las_records.h"

typedef struct copc_node {
	int32_t level, place[3]; /* place: in cubes of the level along x, y, z */
	size_t first, count;     /* points in copc_tree.order; count > 0 */
} copc_node;

typedef struct copc_tree {
	double center[3], half_size; /* of the cube, which holds all points */
	double spacing;              /* between points of the root */
	size_t *order;               /* owned; points of the cloud, node after node */
	copc_node *node;             /* owned; level after level, the root first */
	size_t node_count;           /* 0 for a cloud without points */
} copc_tree;

/* records: tell where the points are. tree: to be given back with copc_tree_clear, also on failure.
 * GW_ERROR_MEMORY. */
gw_status copc_tree_make(copc_tree *tree, const las_records *records, gw_error *error);

void copc_tree_clear(copc_tree *tree);

#endif
