/*
 * octree_unique.comp - writes each key of a sorted list once, and where it occurs first.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_keys.glsl"

layout(binding = 2) readonly buffer Places { uint place[]; }; /* sums of marks; windowed */
layout(binding = 3, rg32ui) writeonly uniform uimageBuffer key_out;
layout(binding = 4, r32ui) writeonly uniform uimageBuffer first_out;

void main()
{
	uint local = gl_GlobalInvocationID.x, i = push.first + local;
	if (local >= push.count || !begins(i))
		return;
	int at = int(place[local]);
	imageStore(key_out, at, uvec4(read_key(i), 0u, 0u));
	imageStore(first_out, at, uvec4(i));
}
