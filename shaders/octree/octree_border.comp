/*
 * octree_border.comp - the border tiles that a level's tiles need (Salm 4.3.3, figures 4.8, 4.9).
 *
 * A sample within half a voxel of a tile's negative side is taken from the tile beyond it. A voxel
 * that isn't empty and lies at that side, or at several sides, is seen from beyond each of them
 * and from beyond their common edges and corner.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_common.glsl"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer tiles;      /* keys of the parent cells */
layout(binding = 1) uniform usamplerBuffer cells;      /* keys of the cells that aren't empty */
layout(binding = 2) uniform usamplerBuffer cell_first; /* first cell of each tile */
layout(binding = 3) buffer Offsets { uint offset[]; }; /* count, then place; windowed */
layout(binding = 4) writeonly buffer Low { uint low[]; };
layout(binding = 5) writeonly buffer High { uint high[]; };

layout(push_constant) uniform Push { gw_border_push push; };

/* Bit s - 1: the tile beyond the negative sides s is needed. */
uint needed(uint begin, uint end)
{
	uint need = 0u;
	for (uint i = begin; i < end; i++) {
		uint zeros = ~texelFetch(cells, int(i)).x & 7u;
		for (uint s = 1u; s < 8u; s++)
			if ((s & zeros) == s)
				need |= 1u << (s - 1u);
	}
	return need;
}

void main()
{
	uint local = gl_GlobalInvocationID.x, i = push.first + local;
	if (local >= push.count)
		return;
	uint begin = texelFetch(cell_first, int(i)).x;
	uint end = i + 1u < push.tiles ? texelFetch(cell_first, int(i) + 1).x : push.cells;
	uint need = needed(begin, end), found = 0u;
	ivec3 at = ivec3(morton_decode(texelFetch(tiles, int(i)).xy));
	uint to = push.emit != 0u ? push.base + offset[local] : 0u;
	for (uint s = 1u; s < 8u; s++) {
		ivec3 other = at - (ivec3(int(s), int(s >> 1), int(s >> 2)) & 1);
		if ((need >> (s - 1u) & 1u) == 0u || any(lessThan(other, ivec3(0))))
			continue;
		uvec2 key = morton_encode(uvec3(other));
		if (find_key(tiles, push.tiles, key) != 0u)
			continue;
		if (push.emit != 0u) {
			low[to + found] = key.x;
			if (push.wide != 0u)
				high[to + found] = key.y;
		}
		found++;
	}
	if (push.emit == 0u)
		offset[local] = found;
}
