/*
 * octree_join.comp - the second step: which facet of its leaf each disc fragment joins, and so
 * which leaves have two.
 *
 * Fragments whose normal is within 60 degrees of the seed's join the first facet, others the
 * second; foliage joins no other surface, as long as there are no more than two.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer leaf_fragment;
layout(binding = 1) uniform samplerBuffer surfel_normal;
layout(binding = 2, r32ui) uniform uimageBuffer fragment_surfel;
layout(binding = 3) buffer Seeds { uvec4 seed[]; }; /* windowed, as in octree_seed.comp */

layout(push_constant) uniform Push { gw_leaves_push push; };

void main()
{
	uint local = gl_GlobalInvocationID.x, leaf = push.first + local;
	if (local >= push.count)
		return;
	uint begin = texelFetch(leaf_fragment, int(leaf)).x + push.from;
	uint end = texelFetch(leaf_fragment, int(leaf) + 1).x;
	uvec4 start = seed[local];
	if (begin >= end || start.x == 0u)
		return;
	end = min(end, begin + GW_REDUCE_RUN);
	int seed_surfel = int(imageLoad(fragment_surfel, int(start.x - 1u)).x & GW_FRAGMENT_SURFEL);
	vec4 seed_normal = texelFetch(surfel_normal, seed_surfel);
	bool seed_foliage = seed_normal.w == GW_MARK_FOLIAGE;
	for (uint i = begin; i < end; i++) {
		uint word = imageLoad(fragment_surfel, int(i)).x;
		if ((word & GW_FRAGMENT_ROI) != 0u)
			continue;
		vec4 normal = texelFetch(surfel_normal, int(word & GW_FRAGMENT_SURFEL));
		bool foliage = normal.w == GW_MARK_FOLIAGE;
		bool second = dot(normal.xyz, seed_normal.xyz) < 0.5;
		if (foliage || seed_foliage)
			second = foliage != seed_foliage;
		if (!second)
			continue;
		imageStore(fragment_surfel, int(i), uvec4(word | GW_FRAGMENT_FACET));
		if (start.z == 0u)
			start.z = i + 1u;
	}
	seed[local].z = start.z;
}
