/*
 * octree_trace.glsl - tracing rays. Uses the texel buffers ray_directory, node, leaf_tile,
 * lobe_plane and lobe_centre (octree.h). With octree_discs.glsl before it, a plane that does not
 * fill its cell counts only where discs cover it.
 */
#ifndef OCTREE_TRACE_GLSL
#define OCTREE_TRACE_GLSL

#include "trace_constants.h"

/* A plane holds a little beyond its cell, so that neighbouring planes leave no crack. */
layout(constant_id = 3) const float cell_slack = 0.02;

/* Distance along the ray to where it leaves the box from low to high (cells of that size). */
float exit_distance(vec3 origin, vec3 inverse, bvec3 forward, vec3 low, vec3 high)
{
	vec3 far = (mix(low, high, forward) - origin) * inverse;
	return min(far.x, min(far.y, far.z));
}

/* The plane of a surface: normal n and distance d from the origin, n . g = d. */
vec4 tangent_plane_at(vec3 g, vec3 normal)
{
	return vec4(normal, dot(normal, g));
}

/*
 * Does the ray meet a lobe's plane within its cell, nearer than t?
 *
 * Near its start a ray meets the surface it leaves: planes bent by noise, and at convex edges
 * planes that stick out of their cells' surface. So within GW_NEAR cells a plane counts only if its
 * lobe's centre lies above the tangent plane of that surface, and only its front side. A plane
 * that is not like that surface, as the wall at whose foot it ends, is not one of its own: there
 * GW_NEAR_HEIGHT is less, since the floor may leave but a strip of the wall in its cell.
 */
bool hit_plane(int slot, bool filled, bool both_sides, vec3 origin, vec4 tangent_plane,
			   vec3 direction, vec3 centre, inout float t, inout bool behind)
{
	vec4 plane = texelFetch(lobe_plane, slot);
	float approach = dot(plane.xyz, direction);
	if (abs(approach) < 1e-6)
		return false;
	float distance = (plane.w - dot(plane.xyz, origin - centre)) / approach;
	if (distance < 0.0 || distance >= t)
		return false;
	vec3 off = abs(origin + direction * distance - centre);
	if (max(off.x, max(off.y, off.z)) > 0.5 + cell_slack)
		return false;
	if (distance < GW_NEAR) {
		if (approach > 0.0)
			return false;
		float height = dot(tangent_plane.xyz, texelFetch(lobe_centre, slot).xyz) - tangent_plane.w;
		if (height < GW_NEAR_HEIGHT * max(dot(plane.xyz, tangent_plane.xyz), GW_LIKE_LEAST))
			return false;
	}
	if (approach > 0.0) {
		behind = true;
		if (!both_sides)
			return false;
	}
#ifdef TRACE_DISCS
	if (!filled && !is_covered(slot, origin + direction * distance))
		return false;
#endif
	t = distance;
	return true;
}

/*
 * The nearest lobe whose front side the ray meets before t_max. Back sides let it through, because
 * planes that stick out over convex edges would darken what lies behind them, but `behind` says
 * that one was met first; with `both_sides` they stop the ray. tangent_plane is that of the surface
 * it leaves.
 */
bool trace_octree(vec3 origin, vec4 tangent_plane, vec3 direction, float t_max, bool both_sides,
				  out uint lobe, out float t_hit, out bool behind)
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
	behind = false;

	for (uint step = 0u; step < GW_WALK_STEPS && t < t_end; step++) {
		vec3 g = origin + direction * (t + nudge);
		uvec3 cell = uvec3(clamp(g, vec3(0.0), vec3(side - 1.0)));
		uvec3 c = cell >> coarse_shift;
		uint entry = texelFetch(ray_directory, int(c.x + (c.y << directory_level) +
												   (c.z << (2u * directory_level))))
						 .x;
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
					bool filled = ((tile.y >> (24u + octant)) & 1u) != 0u;
					if (hit_plane(slot, filled, both_sides, origin, tangent_plane, direction,
								  centre, t_hit, behind))
						lobe = uint(slot);
					if (((tile.y >> (16u + octant)) & 1u) != 0u &&
						hit_plane(slot + 1, filled, both_sides, origin, tangent_plane, direction,
								  centre, t_hit, behind))
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
