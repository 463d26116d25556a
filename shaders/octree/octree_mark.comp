/*
 * octree_mark.comp - marks the first of equal keys in a sorted list.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_keys.glsl"

layout(binding = 2) writeonly buffer Marks { uint mark[]; }; /* windowed */

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local < push.count)
		mark[local] = begins(push.first + local) ? 1u : 0u;
}
