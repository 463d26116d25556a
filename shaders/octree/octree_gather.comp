/*
 * octree_gather.comp - brings words of the fragments into the sorted order.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"

layout(local_size_x_id = 0) in;

/* The output and the index are windowed. */
layout(binding = 0) readonly buffer Index { uint index[]; };
layout(binding = 1) uniform usamplerBuffer unsorted;
layout(binding = 2) writeonly buffer Sorted { uint sorted[]; };

layout(push_constant) uniform Push { gw_keys_push push; };

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local < push.count)
		sorted[local] = texelFetch(unsorted, int(index[local])).x;
}
