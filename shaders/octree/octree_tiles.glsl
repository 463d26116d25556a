/*
 * octree_tiles.glsl - finding tiles. Uses the texel buffers level_directory and node (octree.h).
 */
#ifndef OCTREE_TILES_GLSL
#define OCTREE_TILES_GLSL

/* Pointer plus one to the tile of a cell's children, at level 0..depth - 1; 0 when there is none.
 */
uint find_tile(uvec3 cell, uint level)
{
	uint t = min(level, directory_level);
	uvec3 c = cell >> (level - t);
	uint offset = ((1u << (3u * t)) - 1u) / 7u;
	uint pointer =
		texelFetch(level_directory, int(offset + c.x + (c.y << t) + (c.z << (2u * t)))).x;
	for (; t < level && pointer != 0u; t++) {
		uvec3 child = (cell >> (level - t - 1u)) & 1u;
		uint octant = child.x | child.y << 1 | child.z << 2;
		pointer = texelFetch(node, int(8u * (pointer - 1u) + octant)).x;
	}
	return pointer;
}

#endif
