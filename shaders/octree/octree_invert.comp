/*
 * octree_invert.comp - where each key went when keys were sorted, from where each came from.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"

layout(local_size_x_id = 0) in;

/* The index is windowed. */
layout(binding = 0) readonly buffer Index { uint index[]; };
layout(binding = 1, r32ui) writeonly uniform uimageBuffer place;

layout(push_constant) uniform Push { gw_keys_push push; };

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local < push.count)
		imageStore(place, int(index[local]), uvec4(push.first + local));
}
