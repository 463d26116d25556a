/*
 * octree_parents.comp - copies keys, or those of their parents, to a list that can be sorted.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_keys.glsl"

layout(binding = 2) writeonly buffer Low { uint low[]; };   /* windowed */
layout(binding = 3) writeonly buffer High { uint high[]; }; /* windowed */

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local >= push.count)
		return;
	uvec2 key = read_key(push.first + local);
	low[local] = key.x;
	if (push.total != 0u)
		high[local] = key.y;
}
