/*
 * octree_seed.comp - the first step of each leaf's reduction: what lies there by RoI, and its
 * largest disc fragment, the seed of its first facet.
 *
 * A run takes GW_REDUCE_RUN fragments of each leaf, in order; long leaves take several runs.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer leaf_fragment;
layout(binding = 1) uniform usamplerBuffer fragment_surfel;
layout(binding = 2) uniform samplerBuffer fragment_weight;
layout(binding = 3) uniform samplerBuffer surfel_normal;
layout(binding = 4) uniform samplerBuffer surfel_albedo;
/* Windowed. Seed: fragment plus one, bits of its weight, first fragment plus one of facet 1, which
 * octree_join.comp finds. */
layout(binding = 5) buffer Seeds { uvec4 seed[]; };
layout(binding = 6) buffer Geometry { vec4 leaf_geometry[]; };

layout(push_constant) uniform Push { gw_leaves_push push; };

/* Foliage is no seed where there is anything else. */
const float GW_FOLIAGE_SEED = 1e-9;

void main()
{
	uint local = gl_GlobalInvocationID.x, leaf = push.first + local;
	if (local >= push.count)
		return;
	uint begin = texelFetch(leaf_fragment, int(leaf)).x + push.from;
	uint end = texelFetch(leaf_fragment, int(leaf) + 1).x;
	if (begin >= end)
		return;
	end = min(end, begin + GW_REDUCE_RUN);
	uvec4 best = seed[local];
	vec4 albedo = vec4(0.0);
	vec3 normal = vec3(0.0);
	for (uint i = begin; i < end; i++) {
		uint surfel = texelFetch(fragment_surfel, int(i)).x;
		float weight = texelFetch(fragment_weight, int(i)).x;
		if ((surfel & GW_FRAGMENT_ROI) != 0u) {
			int s = int(surfel & GW_FRAGMENT_SURFEL);
			vec4 rho = texelFetch(surfel_albedo, s);
			float solid = weight * (1.0 - rho.w);
			albedo += solid * vec4(rho.xyz, 1.0);
			normal += solid * texelFetch(surfel_normal, s).xyz;
		} else {
			if (texelFetch(surfel_normal, int(surfel)).w == GW_MARK_FOLIAGE)
				weight *= GW_FOLIAGE_SEED;
			if (best.x == 0u || weight > uintBitsToFloat(best.y))
				best.xy = uvec2(i + 1u, floatBitsToUint(weight));
		}
	}
	seed[local] = best;
	leaf_geometry[2u * local] += albedo;
	leaf_geometry[2u * local + 1u] += vec4(normal, 0.0);
}
