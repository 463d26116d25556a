/*
 * octree_walk.glsl - finding tiles and tracing rays in the sparse voxel octree.
 *
 * The including shader declares, as texel buffers, what it uses of
 *
 *   usamplerBuffer ray_directory, level_directory, node, leaf_tile;  samplerBuffer lobe_plane;
 *
 * and these specialisation constants. See lib/octree.h for what the buffers hold.
 */
#ifndef OCTREE_WALK_GLSL
#define OCTREE_WALK_GLSL

#include "transport_layout.h"

layout(constant_id = 1) const uint depth = 8u;
layout(constant_id = 2) const uint directory_level = 7u;

#ifdef WALK_TILES
/* Pointer plus one to the tile of a cell's children, at level 0..depth - 1; 0 when there is none. */
uint find_tile(uvec3 cell, uint level)
{
	uint t = min(level, directory_level);
	uvec3 c = cell >> (level - t);
	uint offset = ((1u << (3u * t)) - 1u) / 7u;
	uint pointer = texelFetch(level_directory, int(offset + c.x + (c.y << t) + (c.z << (2u * t)))).x;
	for (; t < level && pointer != 0u; t++) {
		uvec3 child = (cell >> (level - t - 1u)) & 1u;
		uint octant = child.x | child.y << 1 | child.z << 2;
		pointer = texelFetch(node, int(8u * (pointer - 1u) + octant)).x;
	}
	return pointer;
}
#endif

#ifdef WALK_RAYS

/* A plane holds a little beyond its cell, so that neighbouring planes leave no crack. */
layout(constant_id = 3) const float cell_slack = 0.02;

const uint WALK_STEPS = 4096u;

/* Distance along the ray to where it leaves the box from low to high (cells of that size). */
float exit_distance(vec3 origin, vec3 inverse, bvec3 forward, vec3 low, vec3 high)
{
	vec3 far = (mix(low, high, forward) - origin) * inverse;
	return min(far.x, min(far.y, far.z));
}

/* Meets the front side of one lobe's plane within its cell, nearer than t? */
bool hit_plane(vec4 plane, vec3 origin, vec3 direction, vec3 centre, inout float t)
{
	float approach = dot(plane.xyz, direction);
	if (approach >= -1e-6)
		return false;
	float distance = (plane.w - dot(plane.xyz, origin - centre)) / approach;
	if (distance < 0.0 || distance >= t)
		return false;
	vec3 off = abs(origin + direction * distance - centre);
	if (max(off.x, max(off.y, off.z)) > 0.5 + cell_slack)
		return false;
	t = distance;
	return true;
}

/*
 * The nearest lobe whose front side the ray meets before t_max. Back sides are culled, so a ray that
 * leaves a surface never meets the plane it starts on (light-transport: "no epsilon").
 */
bool trace(vec3 origin, vec3 direction, float t_max, out uint lobe, out float t_hit)
{
	float side = exp2(float(depth));
	float nudge = 1e-5 + side * 4e-7;
	bvec3 forward = greaterThanEqual(direction, vec3(0.0));
	vec3 inverse = 1.0 / mix(direction, mix(vec3(-1e-20), vec3(1e-20), forward),
	                         lessThan(abs(direction), vec3(1e-20)));
	uint coarse_shift = depth - directory_level;

	vec3 near = (mix(vec3(side), vec3(0.0), forward) - origin) * inverse;
	float t = max(0.0, max(near.x, max(near.y, near.z)));
	float t_end = min(t_max, exit_distance(origin, inverse, forward, vec3(0.0), vec3(side)));
	lobe = GW_NONE;
	t_hit = t_max;

	for (uint step = 0u; step < WALK_STEPS && t < t_end; step++) {
		vec3 g = origin + direction * (t + nudge);
		uvec3 cell = uvec3(clamp(g, vec3(0.0), vec3(side - 1.0)));
		uvec3 c = cell >> coarse_shift;
		uint entry = texelFetch(ray_directory, int(c.x + (c.y << directory_level) +
		                                           (c.z << (2u * directory_level)))).x;
		vec3 low, high;
		if ((entry & 0x80000000u) == 0u) {
			/* Nothing within entry - 1 cells around this one. */
			float reach = float(max(entry, 1u) - 1u);
			float size = exp2(float(coarse_shift));
			low = (vec3(c) - reach) * size;
			high = (vec3(c) + 1.0 + reach) * size;
		} else {
			uint pointer = (entry & 0x7fffffffu) + 1u;
			uint level = directory_level;
			for (; level < depth - 1u && pointer != 0u; level++) {
				uvec3 child = (cell >> (depth - level - 1u)) & 1u;
				uint octant = child.x | child.y << 1 | child.z << 2;
				pointer = texelFetch(node, int(8u * (pointer - 1u) + octant)).x;
			}
			if (pointer == 0u) {
				/* An empty node of this level. */
				float size = exp2(float(depth - level));
				low = vec3(cell >> (depth - level)) * size;
				high = low + size;
			} else {
				uvec2 tile = texelFetch(leaf_tile, int(pointer - 1u)).xy;
				uint octant = (cell.x & 1u) | (cell.y & 1u) << 1 | (cell.z & 1u) << 2;
				if (((tile.y >> (8u + octant)) & 1u) != 0u) {
					uint leaf = tile.x + uint(bitCount(tile.y & ((1u << octant) - 1u)));
					vec3 centre = vec3(cell) + 0.5;
					int slot = int(2u * leaf);
					if (hit_plane(texelFetch(lobe_plane, slot), origin, direction, centre, t_hit))
						lobe = uint(slot);
					if (((tile.y >> (16u + octant)) & 1u) != 0u &&
					    hit_plane(texelFetch(lobe_plane, slot + 1), origin, direction, centre, t_hit))
						lobe = uint(slot + 1);
					if (lobe != GW_NONE)
						return true;
				}
				low = vec3(cell);
				high = low + 1.0;
			}
		}
		t = max(exit_distance(origin, inverse, forward, low, high), t + nudge);
	}
	return false;
}

#endif
#endif
