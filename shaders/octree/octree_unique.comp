/*
 * octree_unique.comp - writes each key of a sorted list once, and where it occurs first.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_keys.glsl"

layout(binding = 2) readonly buffer Places { uint place[]; }; /* sums of marks; windowed */
layout(binding = 3) writeonly buffer KeysOut { uvec2 key_out[]; };
layout(binding = 4) writeonly buffer First { uint first_out[]; };

void main()
{
	uint local = gl_GlobalInvocationID.x, i = push.first + local;
	if (local >= push.count || !begins(i))
		return;
	key_out[place[local]] = read_key(i);
	first_out[place[local]] = i;
}
