/*
 * shadow_map_splat.comp - draws the facets into a shadow map: of each texel, the distance to the
 * nearest plane in the leaves.
 *
 * One invocation a facet. A facet is drawn as what a shadow ray would meet, its plane within its
 * cell, so the pieces join without holes. Both sides are drawn, because a wall that was scanned
 * from inside keeps the sun out. The nearest is kept by atomicMin on the bits of distances, which
 * order as integers do, so the map does not depend on the order of invocations. Facets near a lamp
 * cover many texels; a run draws one tile of each, and `most` tells how many runs are needed.
 */
#version 460

#include "light/shadow_layout.h"
#include "octree/octree_numbers.glsl"

layout(local_size_x_id = 0) in;
layout(constant_id = 3) const float plane_overlap = 0.02;
layout(binding = 0) uniform usamplerBuffer leaf_cell;
layout(binding = 1) uniform samplerBuffer facet_plane;
layout(binding = 2) buffer Map { uint shadow_map[]; };
layout(binding = 3) buffer Most { uint most; };
layout(binding = 4) uniform usamplerBuffer facet_leaf;
layout(push_constant) uniform Push { gw_shadow_push push; };

#include "light/shadow_ray.glsl"

/* Nearer to the lamp's plane than this, a corner has no place in the map. */
const float NEAREST = 0.01;

/* A box around the part of the plane that lies in the cell: flat where the plane faces an axis. */
void plane_box(vec4 plane, inout vec3 centre, out vec3 extent)
{
	extent = vec3(0.5 + plane_overlap);
	vec3 n = abs(plane.xyz);
	int k = n.x >= max(n.y, n.z) ? 0 : n.y >= n.z ? 1 : 2;
	float reach = extent.x * (n.x + n.y + n.z - n[k]) / n[k];
	float middle = plane.w / plane[k];
	float low = clamp(middle - reach, -extent.x, extent.x);
	float high = clamp(middle + reach, -extent.x, extent.x);
	centre[k] += 0.5 * (low + high);
	extent[k] = 0.5 * (high - low) + 0.01; /* more than roundings */
}

/* Texels from low to below high that the picture of a box may cover. */
void box_bounds(vec3 centre, vec3 extent, out ivec2 low, out ivec2 high)
{
	vec3 middle = shadow_place(centre);
	mat3 axes = transpose(mat3(push.right.xyz, push.up.xyz, push.forward.xyz));
	axes[0] *= extent.x;
	axes[1] *= extent.y;
	axes[2] *= extent.z;
	vec3 reach = abs(axes[0]) + abs(axes[1]) + abs(axes[2]);
	float side = float(push.side);
	low = high = ivec2(0);
	if (middle.z + reach.z <= 0.0)
		return;
	if (middle.z - reach.z <= NEAREST) {
		/* Beside the lamp: anywhere, unless beyond the widest angle of the window. */
		vec2 c = vec2(push.centre_x, push.centre_y);
		vec2 widest = max(abs(c), abs(vec2(side) - c)) / push.right.w * (middle.z + reach.z);
		if (push.origin.w > 0.5 || all(lessThanEqual(abs(middle.xy) - reach.xy, widest)))
			high = ivec2(push.side);
		return;
	}
	vec2 least = vec2(1e9), largest = vec2(-1e9);
	for (uint k = 0u; k < 8u; k++) {
		vec3 s = vec3(k & 1u, (k >> 1) & 1u, k >> 2) * 2.0 - 1.0;
		vec2 texel = shadow_texel(middle + axes * s);
		least = min(least, texel);
		largest = max(largest, texel);
	}
	/* Texels whose middle lies between; a texel's middle is at 0.5, and 0.01 is for roundings. */
	low = ivec2(ceil(clamp(least - 0.51, vec2(0.0), vec2(side))));
	high = ivec2(floor(clamp(largest + 0.51, vec2(0.0), vec2(side))));
}

void draw(ivec2 texel, vec3 centre, vec4 plane)
{
	vec3 origin, direction;
	shadow_ray(vec2(texel) + 0.5, origin, direction);
	float approach = dot(plane.xyz, direction);
	if (abs(approach) < 1e-6)
		return;
	float t = (plane.w - dot(plane.xyz, origin - centre)) / approach;
	vec3 off = abs(origin + direction * t - centre);
	if (t < 0.0 || max(off.x, max(off.y, off.z)) > 0.5 + plane_overlap)
		return;
	uint depth = floatBitsToUint(min(t * length(direction) / push.up.w, 1.0));
	uint index = uint(texel.y) * push.side + uint(texel.x);
	if (shadow_map[index] > depth)
		atomicMin(shadow_map[index], depth);
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	int facet = int(push.first + i);
	vec4 plane = texelFetch(facet_plane, facet);
	if (dot(plane.xyz, plane.xyz) < 0.25)
		return;
	uint leaf = leaf_of(texelFetch(facet_leaf, facet).x);
	vec3 centre = vec3(texelFetch(leaf_cell, int(leaf)).xyz) + 0.5;
	ivec2 low, high;
	vec3 middle = centre, extent;
	plane_box(plane, middle, extent);
	box_bounds(middle, extent, low, high);
	if (any(greaterThanEqual(low, high)))
		return;
	uvec2 tiles = (uvec2(high - low) + GW_SHADOW_TILE - 1u) / GW_SHADOW_TILE;
	uint wanted = tiles.x * tiles.y;
	if (push.round >= wanted)
		return;
	if (push.round == 0u && wanted > 1u)
		atomicMax(most, wanted);
	low += ivec2(uvec2(push.round % tiles.x, push.round / tiles.x) * GW_SHADOW_TILE);
	high = min(high, low + int(GW_SHADOW_TILE));
	for (int y = low.y; y < high.y; y++)
		for (int x = low.x; x < high.x; x++)
			draw(ivec2(x, y), centre, plane);
}
