/*
 * octree_leaf.glsl - finding the leaf around a place by the directory that rays use. Uses the texel
 * buffers ray_directory, node and leaf_tile (octree.h); include it after octree_walk.glsl.
 */
#ifndef OCTREE_LEAF_GLSL
#define OCTREE_LEAF_GLSL

#include "octree/octree_numbers.glsl"

uint octant_of(ivec3a cell, uint shift)
{
	ivec3 bit = ivec3(cell >> int(shift) & 1);
	return uint(bit.x | bit.y << 1 | bit.z << 2);
}

/* What the directory says of a cell: how far around it there is nothing, or, with the highest bit
 * set, where its node is. */
uint directory_entry(ivec3a cell)
{
	ivec3 c = ivec3(cell >> int(depth - directory_level));
	return texelFetch(ray_directory, c.x + (c.y << directory_level) +
										 (c.z << (2u * directory_level))).x;
}

/* Goes down from an entry's node toward a cell. Returns the pointer plus one to the tile of the
 * leaves around it, or 0 where a node is empty: one of cells of 2^shift. */
uint find_leaves(uint entry, ivec3a cell, OUT(uint) shift)
{
	uint pointer = (entry & 0x7fffffffu) + 1u;
	for (shift = depth - directory_level; shift > 1u && pointer != 0u; shift--)
		pointer = texelFetch(node, int(8u * (pointer - 1u) + octant_of(cell, shift - 1u))).x;
	return pointer;
}

/* Is a tile's octant a leaf? */
bool holds_leaf(uvec2 tile, uint octant)
{
	return (tile.y >> (8u + octant) & 1u) != 0u;
}

/* The leaf around a place. */
struct LeafAround {
	uvec2 tile;
	uint octant;
};

/* False where there is none. */
bool find_leaf_around(vec3 at, OUT(LeafAround) leaf)
{
	ivec3a cell = clamp(ivec3a(vec3a(at)), ivec3a(0), ivec3a(int(1u << depth) - 1));
	uint entry = directory_entry(cell), shift;
	if (entry >> 31 == 0u)
		return false;
	uint pointer = find_leaves(entry, cell, shift);
	if (pointer == 0u)
		return false;
	leaf.tile = texelFetch(leaf_tile, int(pointer - 1u)).xy;
	leaf.octant = octant_of(cell, 0u);
	return holds_leaf(leaf.tile, leaf.octant);
}

#endif
