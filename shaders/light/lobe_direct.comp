/*
 * lobe_direct.comp - irradiance of each lobe from point, spot and sun lights: the area-weighted
 * mean over the surfels that lie in it. Of leaves with very many fragments every n-th counts, so
 * that no invocation loops long.
 */
#version 460

#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer leaf_fragment;
layout(binding = 1) uniform usamplerBuffer fragment_surfel;
layout(binding = 2) uniform samplerBuffer fragment_weight;
layout(binding = 3) uniform samplerBuffer surfel_irradiance;
layout(binding = 4) writeonly buffer Direct
{
	vec4 lobe_direct[];
};
layout(push_constant) uniform Push
{
	gw_record_push push;
};

const uint FRAGMENTS = 1024u;

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint slot = push.first + i;
	uint first = texelFetch(leaf_fragment, int(slot >> 1)).x;
	uint last = texelFetch(leaf_fragment, int((slot >> 1) + 1u)).x;
	uint stride = max(1u, (last - first) / FRAGMENTS);
	vec3 sum = vec3(0.0);
	float area = 0.0;
	for (uint f = first; f < last; f += stride) {
		uint surfel = texelFetch(fragment_surfel, int(f)).x;
		if ((surfel >> 31) != 0u || ((surfel >> 30) & 1u) != (slot & 1u))
			continue;
		float weight = texelFetch(fragment_weight, int(f)).x;
		sum += weight * texelFetch(surfel_irradiance, int(surfel & 0x3fffffffu)).xyz;
		area += weight;
	}
	lobe_direct[i] = vec4(area > 0.0 ? sum / area : vec3(0.0), 0.0);
}
