/*
 * octree_leaf_tiles.comp - which leaves each leaf tile has, and where each leaf is.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_common.glsl"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer tiles;  /* keys of the leaf tiles' parent cells */
layout(binding = 1) uniform usamplerBuffer leaves; /* keys */
layout(binding = 2) writeonly buffer LeafTiles { uvec2 leaf_tile[]; }; /* windowed */
layout(binding = 3, rgba32ui) writeonly uniform uimageBuffer leaf_cell;

layout(push_constant) uniform Push { gw_leaves_push push; };

void main()
{
	uint local = gl_GlobalInvocationID.x, tile = push.first + local;
	if (local >= push.count)
		return;
	uvec2 parent = texelFetch(tiles, int(tile)).xy;
	uint first = lower_bound(leaves, push.leaves, key_first_child(parent));
	uint bits = 0u;
	for (uint leaf = first; leaf < push.leaves && leaf < first + 8u; leaf++) {
		uvec2 key = texelFetch(leaves, int(leaf)).xy;
		if (key_parent(key) != parent)
			break;
		bits |= 1u << (key.x & 7u);
		imageStore(leaf_cell, int(leaf), uvec4(morton_decode(key), tile));
	}
	/* octree_finish.comp says which leaves are not filled; first facets come when these have
	 * numbers. */
	leaf_tile[local] = uvec2(bits != 0u ? first : 0u, bits | bits << 24);
}
