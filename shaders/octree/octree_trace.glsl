/*
 * octree_trace.glsl - tracing rays. Uses the texel buffers ray_directory, node, leaf_tile,
 * lobe_plane and lobe_centre (octree.h). With octree_discs.glsl before it, a plane that does not
 * fill its cell counts only where discs cover it, and no ray passes between planes.
 */
#ifndef OCTREE_TRACE_GLSL
#define OCTREE_TRACE_GLSL

#include "octree/trace_constants.h"

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

/* What stays the same on a ray's way. */
struct Ray {
	vec3 origin, direction;
	vec4 tangent_plane; /* of the surface that it leaves */
	bool both_sides;
};

/* A lobe as a ray passes it: at a distance t it is approach * t - rise above the plane. */
struct Passage {
	uint lobe; /* slot, or GW_NONE */
	vec3 normal;
	float approach, rise;
	float leave; /* distance at which the ray leaves the lobe's cell */
};

/* A ray's way through a cell. */
struct Stretch {
	vec3 centre;
	float enter, leave; /* distances */
	bool covered;       /* its lobes end nowhere in it */
	bool concave;       /* they meet as a floor and a wall do, seen from inside */
};

float height_over(Passage lobe, float t)
{
	return lobe.approach * t - lobe.rise;
}

/* Is there surface on the lobe's plane where the ray is? Behind a concave crease it goes
 * on as far as the lobe does along it. */
bool holds(Ray ray, Stretch stretch, uint slot, float t)
{
#ifdef TRACE_DISCS
	if (stretch.covered)
		return true;
	vec3 at = ray.origin + ray.direction * t;
	vec3 other = texelFetch(lobe_plane, int(slot ^ 1u)).xyz;
	return (stretch.concave && is_along_crease(int(slot), other, at)) || is_covered(int(slot), at);
#else
	return true;
#endif
}

bool rises_over_start(Ray ray, Passage own, float like_least)
{
	vec3 middle = texelFetch(lobe_centre, int(own.lobe)).xyz;
	float height = dot(ray.tangent_plane.xyz, middle) - ray.tangent_plane.w;
	return height >= GW_NEAR_HEIGHT * max(like_least, GW_LIKE_LEAST);
}

/*
 * Does the ray meet a lobe's plane in or near its cell, nearer than t?
 *
 * Near its start a ray meets the surface it leaves: planes bent by noise, and at convex edges
 * planes that stick out of their cells' surface. So within GW_NEAR cells a plane counts only if its
 * lobe's centre lies above the tangent plane of that surface, and only its front side. A plane
 * that is not like that surface, as the wall at whose foot it ends, is not one of its own: there
 * GW_NEAR_HEIGHT is less, since the floor may leave but a strip of the wall in its cell.
 *
 * Seen from in front a plane may reach far beyond its cell, since what lies behind the surface is
 * dark anyway; seen from behind it would stick out over convex edges and shadow them.
 */
bool meets_plane(Ray ray, Stretch stretch, Passage own, inout float t, inout bool behind)
{
	if (abs(own.approach) < 1e-6)
		return false;
	float distance = own.rise / own.approach;
	if (distance < 0.0 || distance >= t)
		return false;
	vec3 off = abs(ray.origin + ray.direction * distance - stretch.centre);
	float beyond = max(off.x, max(off.y, off.z)) - 0.5, slack = cell_slack;
#ifdef TRACE_DISCS
	slack = own.approach < 0.0 ? GW_FRONT_SLACK : GW_BACK_SLACK;
#endif
	if (beyond > slack)
		return false;
	if (distance < GW_NEAR &&
		(own.approach > 0.0 ||
		 !rises_over_start(ray, own, dot(own.normal, ray.tangent_plane.xyz))))
		return false;
	if (own.approach > 0.0) {
		behind = true;
		if (!ray.both_sides)
			return false;
	}
	stretch.covered = stretch.covered && beyond <= GW_BACK_SLACK;
	if (!holds(ray, stretch, own.lobe, distance))
		return false;
	t = distance;
	return true;
}

#ifdef TRACE_DISCS
/*
 * Is the ray behind the lobe where it enters its cell, though nothing stopped it?
 *
 * Planes of neighbouring cells do not meet, so a ray that was in front of one and is behind the
 * next one of the same surface has passed between them. And at its start a ray is in the rock when
 * noise has put the point behind the wall at whose foot it is.
 */
bool came_through(Ray ray, Stretch stretch, Passage own, Passage last, bool like)
{
	float height = height_over(own, stretch.enter);
	if (!(height < 0.0))
		return false;
	if (stretch.enter < GW_NEAR) {
		if (like || height < -GW_NOISE_DEPTH || own.approach >= 0.0 ||
			!rises_over_start(ray, own, 0.0) ||
			!is_along_crease(int(own.lobe), ray.tangent_plane.xyz, ray.origin))
			return false;
	} else if (!like || last.lobe == GW_NONE || stretch.enter - last.leave > GW_GAP_MOST ||
			   height_over(last, last.leave) < 0.0) {
		return false;
	}
	return holds(ray, stretch, own.lobe, stretch.enter);
}
#endif

/* One lobe of a cell; `last` becomes it when it is of the surface that the ray goes along. */
void meet_lobe(Ray ray, Stretch stretch, uint slot, inout Passage last, inout uint lobe,
			   inout float t, inout bool behind)
{
	vec4 plane = texelFetch(lobe_plane, int(slot));
	Passage own = Passage(slot, plane.xyz, dot(plane.xyz, ray.direction),
						  plane.w - dot(plane.xyz, ray.origin - stretch.centre), stretch.leave);
	if (meets_plane(ray, stretch, own, t, behind)) {
		lobe = slot;
		return;
	}
#ifdef TRACE_DISCS
	bool like = dot(own.normal, last.normal) > GW_LIKE_COSINE;
	if (stretch.enter < t && came_through(ray, stretch, own, last, like)) {
		lobe = slot;
		t = min(t, stretch.leave);
	} else if (like && (stretch.enter >= GW_NEAR || height_over(own, stretch.leave) >= 0.0 ||
						holds(ray, stretch, slot, stretch.leave))) {
		last = own;
	}
#endif
}

/* Does a lobe's centre lie in front of another one's plane? */
bool rises_over(vec3 centre, uint slot, uint over)
{
	vec4 plane = texelFetch(lobe_plane, int(over));
	vec3 middle = texelFetch(lobe_centre, int(slot)).xyz;
	return dot(plane.xyz, middle - centre) - plane.w > GW_CONCAVE_HEIGHT;
}

/* The lobes of a cell that has some. */
void meet_leaf(Ray ray, uvec2 tile, uint octant, inout Stretch stretch, inout Passage last,
			   inout uint lobe, inout float t, inout bool behind)
{
	uint leaf = tile.x + uint(bitCount(tile.y & ((1u << octant) - 1u)));
	bool second = ((tile.y >> (16u + octant)) & 1u) != 0u;
	stretch.covered = ((tile.y >> (24u + octant)) & 1u) != 0u;
	stretch.concave = second && !stretch.covered &&
					  rises_over(stretch.centre, 2u * leaf + 1u, 2u * leaf) &&
					  rises_over(stretch.centre, 2u * leaf, 2u * leaf + 1u);
	meet_lobe(ray, stretch, 2u * leaf, last, lobe, t, behind);
	if (second)
		meet_lobe(ray, stretch, 2u * leaf + 1u, last, lobe, t, behind);
}

/*
 * The nearest lobe whose front side the ray meets before t_max. Back sides let it through, because
 * planes that stick out over convex edges would darken what lies behind them, but `behind` says
 * that one was met first; with `both_sides` they stop the ray. tangent_plane is that of the surface
 * it leaves. Noise may put its start behind that surface, whose planes do not count there; but a
 * ray that is still behind it at a distance of GW_NEAR has gone into the rock.
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
	Ray ray = Ray(origin, direction, tangent_plane, both_sides);
	Passage last = Passage(GW_NONE, tangent_plane.xyz, 0.0, 0.0, 0.0);
	bool near_start = true;

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
				low = vec3(cell);
				high = low + 1.0;
				Stretch stretch = Stretch(low + 0.5, t,
										  exit_distance(origin, inverse, forward, low, high), false,
										  false);
				if (((tile.y >> (8u + octant)) & 1u) != 0u)
					meet_leaf(ray, tile, octant, stretch, last, lobe, t_hit, behind);
				if (lobe != GW_NONE)
					return true;
			}
		}
		t = max(exit_distance(origin, inverse, forward, low, high), t + nudge);
		if (near_start && (t >= GW_NEAR || t >= t_end)) {
			near_start = false;
			if (last.lobe != GW_NONE &&
				height_over(last, min(t_end, max(last.leave, GW_NEAR))) < 0.0) {
				lobe = last.lobe;
				t_hit = min(t_hit, last.leave);
				return true;
			}
		}
	}
	return false;
}

#endif
