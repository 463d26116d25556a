/*
 * octree_link.comp - pointers of the tiles of one level: to their neighbours, from their parent
 * and from the directory.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_common.glsl"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer tiles;   /* keys of the parent cells, of this level */
layout(binding = 1) uniform usamplerBuffer parents; /* the same, of the level above */
layout(binding = 2, rg32ui) writeonly uniform uimageBuffer key_out;
layout(binding = 3, r32ui) writeonly uniform uimageBuffer neighbour;
layout(binding = 4, r32ui) writeonly uniform uimageBuffer node;
layout(binding = 5, r32ui) writeonly uniform uimageBuffer directory;

layout(push_constant) uniform Push { gw_tiles_push push; };

void main()
{
	if (gl_GlobalInvocationID.x >= push.count)
		return;
	uint i = push.first + gl_GlobalInvocationID.x, tile = push.tile_first + i;
	uvec2 key = texelFetch(tiles, int(i)).xy;
	uvec3 at = morton_decode(key);
	uint side = 1u << push.level;
	imageStore(key_out, int(tile), uvec4(key, 0u, 0u));
	imageStore(neighbour, int(8u * tile), uvec4(tile + 1u));
	for (uint o = 1u; o < 8u; o++) {
		uvec3 other = at + (uvec3(o, o >> 1, o >> 2) & 1u);
		uint found = 0u;
		if (all(lessThan(other, uvec3(side))))
			found = find_key(tiles, push.total, morton_encode(other));
		uint pointer = found == 0u ? 0u : push.tile_first + found;
		imageStore(neighbour, int(8u * tile + o), uvec4(pointer));
	}
	if (push.parent_count > 0u) {
		uint parent = find_key(parents, push.parent_count, key_parent(key));
		uint child = 8u * (push.parent_first + parent - 1u) + (key.x & 7u);
		imageStore(node, int(child), uvec4(tile + 1u));
	}
	if (push.directory != 0u) {
		uint t = push.level;
		uint cell = ((1u << (3u * t)) - 1u) / 7u + at.x + (at.y << t) + (at.z << (2u * t));
		imageStore(directory, int(cell), uvec4(tile + 1u));
	}
}
