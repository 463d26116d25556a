/*
 * octree_facets.comp - the second step: adds up the disc fragments of each facet.
 *
 * Fragments whose normal is within 60 degrees of the seed's join the first facet, others the
 * second; foliage joins no other surface, as long as there are no more than two. Slots hold sums
 * until octree_finish.comp: of normals, centroids relative to the cell's centre (both times area),
 * transparencies, areas, albedos, the area of two-sided surfels, and emission.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"
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
layout(binding = 9) buffer Fragments { uint fragment_surfel[]; };
layout(binding = 10) buffer Seeds { uvec4 seed[]; }; /* this and all below: windowed */
layout(binding = 11) buffer Planes { vec4 facet_plane[]; };
layout(binding = 12) buffer Centres { vec4 facet_centre[]; };
layout(binding = 13) buffer Albedos { vec4 facet_albedo[]; };
layout(binding = 14) buffer Emissions { vec4 facet_emission[]; };

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
	uint local = gl_GlobalInvocationID.x, leaf = push.first + local;
	if (local >= push.count)
		return;
	uint begin = texelFetch(leaf_fragment, int(leaf)).x + push.from;
	uint end = texelFetch(leaf_fragment, int(leaf) + 1).x;
	uvec4 start = seed[local];
	if (begin >= end || start.x == 0u)
		return;
	end = min(end, begin + GW_REDUCE_RUN);
	uvec3 cell = texelFetch(leaf_cell, int(leaf)).xyz;
	int seed_surfel = int(fragment_surfel[start.x - 1u] & GW_FRAGMENT_SURFEL);
	vec4 seed_normal = texelFetch(surfel_normal, seed_surfel);
	bool seed_foliage = seed_normal.w == GW_MARK_FOLIAGE;
	vec4 plane[2] = vec4[2](vec4(0.0), vec4(0.0)), centre[2] = plane, albedo[2] = plane;
	vec3 emission[2] = vec3[2](vec3(0.0), vec3(0.0));
	for (uint i = begin; i < end; i++) {
		uint word = fragment_surfel[i];
		if ((word & GW_FRAGMENT_ROI) != 0u)
			continue;
		int s = int(word & GW_FRAGMENT_SURFEL);
		float area = texelFetch(fragment_weight, int(i)).x;
		vec4 normal = texelFetch(surfel_normal, s);
		bool foliage = normal.w == GW_MARK_FOLIAGE;
		bool second = dot(normal.xyz, seed_normal.xyz) < 0.5;
		if (foliage || seed_foliage)
			second = foliage != seed_foliage;
		if (foliage && !seed_foliage)
			area *= GW_FOLIAGE_WEIGHT;
		vec3 c = patch_centroid(i, cell, texelFetch(surfel_position, s).xyz,
								texelFetch(surfel_bend, s).xyz, normal.xyz);
		vec2 share = second ? vec2(0.0, area) : vec2(area, 0.0);
		vec4 rho = texelFetch(surfel_albedo, s);
		if (foliage)
			rho.w = 0.0;
		for (int k = 0; k < 2; k++) {
			plane[k] += share[k] * vec4(normal.xyz, rho.w);
			centre[k] += share[k] * vec4(c, 1.0);
			albedo[k] += share[k] * vec4(rho.xyz, max(normal.w, 0.0));
			if (push.emissive != 0u)
				emission[k] += share[k] * texelFetch(surfel_emission, s).xyz;
		}
		if (second) {
			fragment_surfel[i] = word | GW_FRAGMENT_FACET;
			if (start.z == 0u)
				start.z = i + 1u;
		}
	}
	seed[local].z = start.z;
	for (uint k = 0u; k < 2u; k++) {
		facet_plane[2u * local + k] += plane[k];
		facet_centre[2u * local + k] += centre[k];
		facet_albedo[2u * local + k] += albedo[k];
		if (push.emissive != 0u)
			facet_emission[2u * local + k] += vec4(emission[k], 0.0);
	}
}
