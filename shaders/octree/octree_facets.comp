/*
 * octree_facets.comp - the third step: adds up the disc fragments of each facet, one an invocation.
 *
 * Facets hold sums until octree_finish.comp: of normals, centroids relative to the cell's centre
 * (both times area), transparencies, areas, albedos, the area of two-sided surfels, and emission.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_numbers.glsl"
#include "octree/trace_constants.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer leaf_fragment;
layout(binding = 1) uniform usamplerBuffer leaf_cell;
layout(binding = 2) uniform samplerBuffer fragment_weight;
layout(binding = 3) uniform usamplerBuffer fragment_centroid;
layout(binding = 4) uniform samplerBuffer surfel_position;
layout(binding = 5) uniform samplerBuffer surfel_normal;
layout(binding = 6) uniform samplerBuffer surfel_albedo;
layout(binding = 7) uniform samplerBuffer surfel_emission;
layout(binding = 8) uniform samplerBuffer surfel_bend;
layout(binding = 9) uniform usamplerBuffer fragment_surfel;
layout(binding = 10) uniform usamplerBuffer seed;
layout(binding = 11) uniform usamplerBuffer facet_leaf;
layout(binding = 12) buffer Planes { vec4 facet_plane[]; }; /* this and all below: windowed */
layout(binding = 13) buffer Centres { vec4 facet_centre[]; };
layout(binding = 14) buffer Albedos { vec4 facet_albedo[]; };
layout(binding = 15) buffer Emissions { vec4 facet_emission[]; };

layout(push_constant) uniform Push { gw_leaves_push push; };

/* Centroid of the bent disc's part in the cell, relative to the cell's centre, and the normal
 * there. It was stored to 10 bits a coordinate; that it lies on the disc makes its height exact. */
vec3 patch_centroid(uint fragment, uvec3 cell, vec3 position, vec3 bend, inout vec3 normal)
{
	uint bits = texelFetch(fragment_centroid, int(fragment)).x;
	vec3 c = vec3(uvec3(bits, bits >> 10, bits >> 20) & 0x3ffu) / 1023.0 - 0.5;
	vec3 centre = position - vec3(cell) - 0.5;
	vec3 t, b, off = c - centre;
	tangent_frame(normal, t, b);
	vec2 at = vec2(dot(t, off), dot(b, off));
	vec2 rise = vec2(dot(bend.xy, at), dot(bend.yz, at));
	c += normal * (0.5 * dot(rise, at) - dot(normal, off));
	normal = normalize(normal - t * rise.x - b * rise.y);
	return c;
}

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local >= push.count || push.first + local == GW_FACET_EMPTY)
		return;
	uint own = texelFetch(facet_leaf, int(push.first + local)).x, leaf = leaf_of(own);
	uint begin = texelFetch(leaf_fragment, int(leaf)).x + push.from;
	uint end = texelFetch(leaf_fragment, int(leaf) + 1).x;
	uint start = texelFetch(seed, int(leaf)).x;
	if (begin >= end || start == 0u)
		return;
	end = min(end, begin + GW_REDUCE_RUN);
	uvec3 cell = texelFetch(leaf_cell, int(leaf)).xyz;
	uint seed_surfel = texelFetch(fragment_surfel, int(start - 1u)).x & GW_FRAGMENT_SURFEL;
	bool seed_foliage = texelFetch(surfel_normal, int(seed_surfel)).w == GW_MARK_FOLIAGE;
	vec4 plane = vec4(0.0), centre = plane, albedo = plane;
	vec3 emission = vec3(0.0);
	for (uint i = begin; i < end; i++) {
		uint word = texelFetch(fragment_surfel, int(i)).x;
		if (!is_disc_of(own, word))
			continue;
		int s = int(word & GW_FRAGMENT_SURFEL);
		float area = texelFetch(fragment_weight, int(i)).x;
		vec4 normal = texelFetch(surfel_normal, s);
		bool foliage = normal.w == GW_MARK_FOLIAGE;
		if (foliage && !seed_foliage)
			area *= GW_FOLIAGE_WEIGHT;
		vec3 c = patch_centroid(i, cell, texelFetch(surfel_position, s).xyz,
								texelFetch(surfel_bend, s).xyz, normal.xyz);
		vec4 rho = texelFetch(surfel_albedo, s);
		if (foliage)
			rho.w = 0.0;
		plane += area * vec4(normal.xyz, rho.w);
		centre += area * vec4(c, 1.0);
		albedo += area * vec4(rho.xyz, max(normal.w, 0.0));
		if (push.emissive != 0u)
			emission += area * texelFetch(surfel_emission, s).xyz;
	}
	facet_plane[local] += plane;
	facet_centre[local] += centre;
	facet_albedo[local] += albedo;
	if (push.emissive != 0u)
		facet_emission[local] += vec4(emission, 0.0);
}
