/*
 * octree_finish.comp - the last step: turns the sums of each facet into means, and says in the
 * leaf's tile, and in its cell of the directory, that there are facets and whether they fill it.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"
#include "octree/trace_constants.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer leaf_cell;
layout(binding = 1) uniform usamplerBuffer fragment_surfel;
layout(binding = 2) uniform samplerBuffer surfel_position;
layout(binding = 3) uniform samplerBuffer surfel_normal;
layout(binding = 4) readonly buffer Seeds { uvec4 seed[]; }; /* this and the next four: windowed */
layout(binding = 5) buffer Planes { vec4 facet_plane[]; };
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
bool finish_facet(uint slot, uvec3 cell, uint first, bool seed_foliage)
{
	int surfel = int(texelFetch(fragment_surfel, int(first)).x & GW_FRAGMENT_SURFEL);
	vec3 sum = facet_plane[slot].xyz;
	float clear = facet_plane[slot].w;
	vec4 centre = facet_centre[slot], albedo = facet_albedo[slot];
	float area = centre.w, length_of_sum = length(sum);
	/* Rounding aside it is all or not. */
	bool foliage = area > 0.0 && albedo.w > 0.999 * GW_MARK_FOLIAGE * area;
	/* 1e-6 of the area is what rounding leaves of normals that cancel. */
	vec3 normal = length_of_sum > 1e-6 * area ? sum / length_of_sum
	                                          : texelFetch(surfel_normal, surfel).xyz;
	float scale = area > 0.0 ? 1.0 / area : 0.0;
	vec3 c = clamp(centre.xyz * scale, -0.5, 0.5);
	float offset = dot(normal, area > 0.0 ? centre.xyz * scale : c);
	facet_plane[slot] = vec4(normal, offset);
	float weight = foliage && !seed_foliage ? GW_FOLIAGE_WEIGHT : 1.0;
	facet_centre[slot] = vec4(vec3(cell) + 0.5 + c, area / weight);
	float sides = 2.0 * albedo.w > area ? 1.0 : albedo.w > 0.0 ? GW_FACET_UNCLEAR : 0.0;
	vec2 kind = vec2(sides, min(clear * scale, CLEAREST));
	if (foliage)
		kind = vec2(GW_FACET_FOLIAGE, GW_FOLIAGE_CLEAR);
	facet_albedo[slot] = vec4(albedo.xyz * scale, kind.x + kind.y);
	if (push.emissive != 0u)
		facet_emission[slot] = vec4(facet_emission[slot].xyz * scale, 0.0);
	return !foliage && area >= FILLED * area_in_cell(normal, offset);
}

void main()
{
	uint local = gl_GlobalInvocationID.x, leaf = push.first + local;
	if (local >= push.count)
		return;
	uvec4 cell = texelFetch(leaf_cell, int(leaf));
	uint octant = (cell.x & 1u) | (cell.y & 1u) << 1 | (cell.z & 1u) << 2;
	uvec4 start = seed[local];
	if (start.x == 0u)
		return;
	uint bits = 1u << (8u + octant);
	int surfel = int(texelFetch(fragment_surfel, int(start.x - 1u)).x & GW_FRAGMENT_SURFEL);
	bool foliage = texelFetch(surfel_normal, surfel).w == GW_MARK_FOLIAGE;
	bool filled = finish_facet(2u * local, cell.xyz, start.x - 1u, foliage);
	if (start.z != 0u) {
		bits |= 1u << (16u + octant);
		if (!finish_facet(2u * local + 1u, cell.xyz, start.z - 1u, foliage))
			filled = false;
	}
	if (filled)
		bits |= 1u << (24u + octant);
	atomicOr(leaf_tile[cell.w].y, bits);
	uint t = push.directory_level;
	uvec3 c = cell.xyz >> (push.depth - t);
	atomicOr(mark[c.x + (c.y << t) + (c.z << (2u * t))], 1u);
}
