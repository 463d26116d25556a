/*
 * octree_reference.h - a simple octree on the CPU, to compare the device's with.
 */
#ifndef OCTREE_REFERENCE_H
#define OCTREE_REFERENCE_H

#include "octree/octree.h"

/* Arrays as the buffers of gw_octree of the same names. */
typedef struct octree_reference {
	uint32_t directory_level, tile_count, leaf_tile_count, border_tile_count;
	uint32_t tile_first[GW_DEPTH_MAX + 2];
	uint32_t *tile_key, *leaf_tile_key, *node, *tile_neighbour, *leaf_tile_neighbour;
	uint32_t *leaf_tile; /* without second facets */
	uint32_t *leaf_cell, *level_directory, *ray_directory;
	uint64_t level_entries, ray_entries;
} octree_reference;

/*
 * Builds tiles, pointers and directories over the given leaves.
 *   leaf_cell  4 * leaf_count: x, y, z and something; in Morton order
 *   has_facet   leaf_count
 * False when memory is short or the leaves are not in order.
 */
bool octree_reference_make(uint32_t depth, const uint32_t *leaf_cell, const uint8_t *has_facet,
						   uint32_t leaf_count, octree_reference *reference);
void octree_reference_clear(octree_reference *reference);

/* Opacity that the RoI of a surfel gives to a leaf cell: overlap volume / side, leaf cells^2. */
double octree_reference_roi(const gw_surfels *surfels, const float cube_minimum[3],
							double leaf_size, uint32_t surfel, const uint32_t cell[3]);

#endif
