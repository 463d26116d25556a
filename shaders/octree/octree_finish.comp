/*
 * octree_finish.comp - the last step: turns the sums of each facet into means, and says in the
 * leaf's tile, and in its cell of the directory, that there are facets and whether they fill it.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_numbers.glsl"
#include "octree/trace_constants.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer leaf_cell;
layout(binding = 1) uniform usamplerBuffer fragment_surfel;
layout(binding = 2) uniform usamplerBuffer facet_leaf;
layout(binding = 3) uniform samplerBuffer surfel_normal;
layout(binding = 4) uniform usamplerBuffer seed;
layout(binding = 5) buffer Planes { vec4 facet_plane[]; }; /* this and the next three: windowed */
layout(binding = 6) buffer Centres { vec4 facet_centre[]; };
layout(binding = 7) buffer Albedos { vec4 facet_albedo[]; };
layout(binding = 8) buffer Emissions { vec4 facet_emission[]; };
layout(binding = 9) buffer LeafTiles { uvec2 leaf_tile[]; };
layout(binding = 10) buffer Marks { uint mark[]; }; /* of the cells of the directory's level */

layout(push_constant) uniform Push { gw_leaves_push push; };

/* A facet with less area than this share of its plane's in the cell has an edge there, or a gap. */
const float FILLED = 0.85;

/* Transparency is kept as a fraction. */
const float CLEAREST = 0.9999;

/* Area of the plane n . (g - centre) = c within a unit cell: the derivative by c of the volume
 * below it, which is a sum over the corners. Directions nearly along an axis, where rounding would
 * take over, are turned off it by SLANT. */
float area_in_cell(vec3 n, float c)
{
	const float SLANT = 0.02;
	n = normalize(max(abs(n), vec3(SLANT)));
	float sum = 0.0;
	for (int i = 0; i < 8; i++) {
		vec3 corner = vec3(i & 1, i >> 1 & 1, i >> 2) - 0.5;
		float above = max(c - dot(n, corner), 0.0);
		sum += (bitCount(i) & 1) == 0 ? above * above : -above * above;
	}
	return sum / (2.0 * n.x * n.y * n.z);
}

/* Returns whether the facet fills its cell. `first`: a fragment of the facet, for facets without
 * area or whose normals cancel. */
bool finish_facet(uint local, uvec3 cell, uint first, bool seed_foliage)
{
	int surfel = int(texelFetch(fragment_surfel, int(first)).x & GW_FRAGMENT_SURFEL);
	vec3 sum = facet_plane[local].xyz;
	float clear = facet_plane[local].w;
	vec4 centre = facet_centre[local], albedo = facet_albedo[local];
	float area = centre.w, length_of_sum = length(sum);
	/* Rounding aside it is all or not. */
	bool foliage = area > 0.0 && albedo.w > 0.999 * GW_MARK_FOLIAGE * area;
	/* 1e-6 of the area is what rounding leaves of normals that cancel. */
	vec3 normal = length_of_sum > 1e-6 * area ? sum / length_of_sum
	                                          : texelFetch(surfel_normal, surfel).xyz;
	float scale = area > 0.0 ? 1.0 / area : 0.0;
	vec3 c = clamp(centre.xyz * scale, -0.5, 0.5);
	float offset = dot(normal, area > 0.0 ? centre.xyz * scale : c);
	facet_plane[local] = vec4(normal, offset);
	float weight = foliage && !seed_foliage ? GW_FOLIAGE_WEIGHT : 1.0;
	facet_centre[local] = vec4(vec3(cell) + 0.5 + c, area / weight);
	float sides = 2.0 * albedo.w > area ? 1.0 : albedo.w > 0.0 ? GW_FACET_UNCLEAR : 0.0;
	vec2 kind = vec2(sides, min(clear * scale, CLEAREST));
	if (foliage)
		kind = vec2(GW_FACET_FOLIAGE, GW_FOLIAGE_CLEAR);
	facet_albedo[local] = vec4(albedo.xyz * scale, kind.x + kind.y);
	if (push.emissive != 0u)
		facet_emission[local] = vec4(facet_emission[local].xyz * scale, 0.0);
	return !foliage && area >= FILLED * area_in_cell(normal, offset);
}

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local >= push.count || push.first + local == GW_FACET_EMPTY)
		return;
	uint own = texelFetch(facet_leaf, int(push.first + local)).x;
	uvec4 cell = texelFetch(leaf_cell, int(leaf_of(own)));
	uvec4 start = texelFetch(seed, int(leaf_of(own)));
	uint octant = (cell.x & 1u) | (cell.y & 1u) << 1 | (cell.z & 1u) << 2;
	bool filled = false;
	if (start.x != 0u) {
		int surfel = int(texelFetch(fragment_surfel, int(start.x - 1u)).x & GW_FRAGMENT_SURFEL);
		bool foliage = texelFetch(surfel_normal, surfel).w == GW_MARK_FOLIAGE;
		uint first = is_second(own) ? start.z : start.x;
		filled = finish_facet(local, cell.xyz, first - 1u, foliage);
		atomicOr(leaf_tile[cell.w].y, 1u << ((is_second(own) ? 16u : 8u) + octant));
		uint t = push.directory_level;
		uvec3 c = cell.xyz >> (push.depth - t);
		atomicOr(mark[c.x + (c.y << t) + (c.z << (2u * t))], 1u);
	}
	/* Until one of its facets does not, or there is none, a leaf counts as filled. */
	if (!filled)
		atomicAnd(leaf_tile[cell.w].y, ~(1u << (24u + octant)));
}
