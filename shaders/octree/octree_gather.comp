/*
 * octree_gather.comp - brings what belongs to the fragments into the sorted order.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"

layout(local_size_x_id = 0) in;

/* All outputs and the index are windowed. */
layout(binding = 0) readonly buffer Index { uint index[]; };
layout(binding = 1) uniform usamplerBuffer surfel;
layout(binding = 2) uniform samplerBuffer weight;
layout(binding = 3) uniform usamplerBuffer middle;
layout(binding = 4) writeonly buffer SurfelOut { uint surfel_out[]; };
layout(binding = 5) writeonly buffer WeightOut { float weight_out[]; };
layout(binding = 6) writeonly buffer CentroidOut { uint centroid_out[]; };

layout(push_constant) uniform Push { gw_keys_push push; };

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local >= push.count)
		return;
	int from = int(index[local]);
	surfel_out[local] = texelFetch(surfel, from).x;
	weight_out[local] = texelFetch(weight, from).x;
	centroid_out[local] = texelFetch(middle, from).x;
}
