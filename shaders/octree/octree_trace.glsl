/*
 * octree_trace.glsl - tracing rays. Uses the texel buffers ray_directory, node, leaf_tile,
 * facet_plane and facet_centre (octree.h), and what opacity.glsl uses. With octree_discs.glsl
 * before it, a plane that does not fill its cell counts only where discs cover it, and no ray
 * passes between planes.
 */
#ifndef OCTREE_TRACE_GLSL
#define OCTREE_TRACE_GLSL

#include "octree/opacity.glsl"
#include "octree/octree_leaf.glsl"
#include "octree/trace_constants.h"

#ifndef TRACE_DISCS
#define TRACE_DISCS false
bool passes_crest(IN(Ray), uint, float, vec3, vec3)
{
	return false;
}

Owner owner_of(uint facet)
{
	Owner owner = { facet, 0u };
	return owner;
}

bool is_covered(IN(Owner), vec3)
{
	return true;
}

bool is_along_crease(IN(Owner), vec3, vec3)
{
	return false;
}

void meet_discs(IN(Ray), uint, vec3, INOUT(Doubt), INOUT(Hit))
{
}
#endif

/* A plane holds a little beyond its cell, so that neighbouring planes leave no crack. */
CONSTANT(3, float, plane_overlap, 0.02f);

/* A facet as a ray passes it: at a distance t it is approach * t - rise above the plane. */
struct Passage {
	uint facet; /* its number, or GW_NONE */
	vec3 normal;
	float approach, rise;
	float leave; /* distance at which the ray leaves the facet's cell */
};

/* A ray's way through a cell. */
struct Stretch {
	vec3 centre;
	uint first;         /* of its leaf's facets */
	float enter, leave; /* distances */
	bool covered;       /* its facets end nowhere in it */
	bool concave;       /* they meet as a floor and a wall do, seen from inside */
};

/* How a ray meets a facet: on its plane; behind it, where it enters the cell; or it goes along it.
 */
#define MEET_PLANE 0u
#define MEET_BEHIND 1u
#define MEET_ALONG 2u

/* Where a ray may meet a facet, and whether there is surface for certain. */
struct Meeting {
	uint step;
	float t;
	bool covered;
};

float height_over(IN(Passage) facet, float t)
{
	return facet.approach * t - facet.rise;
}

/* Is there surface on the facet's plane where the ray is? Behind a concave crease it goes
 * on as far as the facet does along it. */
bool holds(IN(Ray) ray, IN(Stretch) stretch, bool covered, uint facet, float t)
{
	if (!TRACE_DISCS || covered)
		return true;
	vec3 at = ray.origin + ray.direction * t;
	Owner owner = owner_of(facet);
	if (stretch.concave) {
		uint other = facet == stretch.first ? facet + 1u : stretch.first;
		if (is_along_crease(owner, texelFetch(facet_plane, int(other)).xyz, at))
			return true;
	}
	return is_covered(owner, at) &&
		   !passes_crest(ray, leaf_of(owner.word), t, texelFetch(facet_plane, int(facet)).xyz,
						 texelFetch(facet_centre, int(facet)).xyz);
}

/* Does a facet rise over the surface that the ray leaves? Noise and bends lift a little what is
 * like that surface, or like its other side.
 *   like   cosine between their normals, as far as it counts */
bool rises_over_start(IN(Ray) ray, IN(Passage) own, float like)
{
	vec3 middle = texelFetch(facet_centre, int(own.facet)).xyz;
	float height = dot(ray.facing, middle) - dot(ray.facing, ray.foot);
	return height >= GW_NEAR_HEIGHT * max(max(like, -GW_LIKE_OTHER * like), GW_LIKE_LEAST);
}

/* How far a plane reaches beyond its cell, for a ray that comes so fast nearer to its front. */
float plane_overlap_for(float approach)
{
	if (!TRACE_DISCS)
		return plane_overlap;
	return approach < 0.0f ? GW_PLANE_FRONT_OVERLAP : GW_PLANE_BACK_OVERLAP;
}

/*
 * Does the ray meet a facet's plane in or near its cell, nearer than what it has hit?
 *
 * Near its start a ray meets the surface it leaves: planes bent by noise, and at convex edges
 * planes that stick out of their cells' surface. So within GW_NEAR cells a plane counts only if its
 * facet's centre lies above the tangent plane of that surface, and only its front side, or the back
 * of another sheet that lets light through. A plane that is like neither side of that surface, as
 * the wall at whose foot it ends, is not one of its own: there GW_NEAR_HEIGHT is less, since the
 * floor may leave but a strip of the wall in its cell.
 *
 * Seen from in front a plane may reach far beyond its cell, since what lies behind the surface is
 * dark anyway; seen from behind it would stick out over convex edges and shadow them.
 */
bool meets_plane(IN(Ray) ray, IN(Stretch) stretch, IN(Passage) own, INOUT(Hit) hit,
				 INOUT(Meeting) meeting)
{
	meeting.t = own.rise / own.approach;
	if (abs(own.approach) < 1e-6f || meeting.t < 0.0f || meeting.t >= hit.t)
		return false;
	vec3 off = ray.origin + ray.direction * meeting.t - stretch.centre;
	float beyond = max(abs(off.x), max(abs(off.y), abs(off.z))) - 0.5f;
	if (beyond > plane_overlap_for(own.approach))
		return false;
	if (meeting.t < GW_NEAR &&
		(own.approach > 0.0f ? !lies_over_start(ray, own.facet, own.rise)
							 : !rises_over_start(ray, own, dot(own.normal, ray.facing))))
		return false;
	if (is_passed(ray, own.normal, meeting.t))
		return false;
	if (own.approach > 0.0f && !stops_from_behind(own.facet)) {
		hit.passed_back_face = true;
		if (!ray.both_sides)
			return false;
	}
	meeting.covered = stretch.covered && beyond <= GW_PLANE_BACK_OVERLAP;
	return true;
}

/*
 * Is the ray behind the facet where it enters its cell, though nothing stopped it?
 *
 * Planes of neighbouring cells do not meet, so a ray that was in front of one and is behind the
 * next one of the same surface has passed between them. And at its start a ray is in the rock when
 * noise has put the point behind the wall at whose foot it is.
 */
bool came_through(IN(Ray) ray, IN(Stretch) stretch, IN(Passage) own, IN(Passage) last, bool like)
{
	float height = height_over(own, stretch.enter);
	if (!(height < 0.0f))
		return false;
	if (stretch.enter < GW_NEAR)
		return !like && height >= -GW_NOISE_DEPTH && own.approach < 0.0f &&
			   rises_over_start(ray, own, min(dot(own.normal, ray.facing), 0.0f)) &&
			   is_along_crease(owner_of(own.facet), ray.facing, ray.origin);
	return like && last.facet != GW_NONE && stretch.enter - last.leave <= GW_GAP_MOST &&
		   height_over(last, last.leave) >= 0.0f;
}

/* Whether the ray meets the facet there if there is surface, or goes along it; and where that is.
 */
bool may_meet(IN(Ray) ray, IN(Stretch) stretch, IN(Passage) own, IN(Passage) last, INOUT(Hit) hit,
			  INOUT(Meeting) meeting)
{
	bool like = dot(own.normal, last.normal) > GW_LIKE_COSINE;
	meeting.covered = stretch.covered;
	if (meeting.step == MEET_PLANE)
		return meets_plane(ray, stretch, own, hit, meeting);
	if (meeting.step == MEET_BEHIND) {
		meeting.t = stretch.enter;
		return meeting.t < hit.t && came_through(ray, stretch, own, last, like) &&
			   !is_passed(ray, own.normal, meeting.t);
	}
	meeting.t = stretch.leave;
	meeting.covered =
		meeting.covered || stretch.enter >= GW_NEAR || height_over(own, stretch.leave) >= 0.0f;
	return like;
}

/* One facet of a cell; `last` becomes it when it is of the surface that the ray goes along. Whether
 * there is surface is asked in one place, since drivers write functions out where they are called.
 */
void meet_facet(IN(Ray) ray, IN(Stretch) stretch, uint facet, INOUT(Passage) last, INOUT(Hit) hit)
{
	vec4 plane = texelFetch(facet_plane, int(facet));
	float rise = plane.w - dot(plane.xyz, ray.origin - stretch.centre);
	Passage own = { facet, plane.xyz, dot(plane.xyz, ray.direction), rise, stretch.leave };
	for (uint step = MEET_PLANE; step <= (TRACE_DISCS ? MEET_ALONG : MEET_PLANE); step++) {
		Meeting meeting = { step, 0.0f, false };
		if (!may_meet(ray, stretch, own, last, hit, meeting) ||
			!holds(ray, stretch, meeting.covered, facet, meeting.t))
			continue;
		if (step == MEET_ALONG) {
			last = own;
		} else {
			hit.facet = facet;
			hit.t = step == MEET_PLANE ? meeting.t : min(hit.t, stretch.leave);
		}
		return;
	}
}

/* Does a facet's centre lie in front of another one's plane? */
bool rises_over(vec3 centre, uint facet, uint over)
{
	vec4 plane = texelFetch(facet_plane, int(over));
	vec3 middle = texelFetch(facet_centre, int(facet)).xyz;
	return dot(plane.xyz, middle - centre) - plane.w > GW_CONCAVE_HEIGHT;
}

/* What a ray knows of the cells that it has come through. */
struct Past {
	Passage last; /* of the surface that it goes along */
	Doubt doubt;
	bool again; /* it goes its way a second time, against discs */
};

/* The facets of a leaf that has some; or, again, its discs. */
void meet_leaf(IN(Ray) ray, uvec2 tile, uint octant, INOUT(Stretch) stretch, INOUT(Past) past,
			   INOUT(Hit) hit)
{
	uint first = first_facet(tile, octant);
	bool second = has_second(tile, octant);
	stretch.first = first;
	stretch.covered = (tile.y >> (24u + octant) & 1u) != 0u;
	bool foliage = is_foliage(first), more = second && is_foliage(first + 1u);
	if (foliage && (!second || more)) {
		if (!past.again)
			pass_foliage(first, stretch.enter, stretch.leave, hit);
		return;
	}
	if (TRACE_DISCS && !stretch.covered && !past.again) {
		past.doubt.from = min(past.doubt.from, stretch.enter);
		past.doubt.to = stretch.enter;
	}
	if (past.again) {
		if (!stretch.covered)
			meet_discs(ray, first, stretch.centre, past.doubt, hit);
		return;
	}
	stretch.concave = second && !stretch.covered && !stops_from_behind(first) &&
					  !stops_from_behind(first + 1u) &&
					  rises_over(stretch.centre, first + 1u, first) &&
					  rises_over(stretch.centre, first, first + 1u);
	for (uint k = foliage ? 1u : 0u; k < (second && !more ? 2u : 1u); k++)
		meet_facet(ray, stretch, first + k, past.last, hit);
	if (foliage || more)
		pass_foliage(first + (more ? 1u : 0u), stretch.enter, stretch.leave, hit);
}

/* ------------------------------------------------------------------------------------- walking */

/* What stays the same on a ray's way. */
struct Walk {
	vec3a origin, direction, inverse;
	vec3a ahead; /* 1 where the ray goes up, -1 where it goes down */
	vec3a far;   /* 1 where it goes up, else 0: the side on which it leaves a cell */
	ivec3a last; /* of the octree's cells */
};

float smallest(vec3a of)
{
	vec3 v = vec3(of);
	return min(v.x, min(v.y, v.z));
}

float largest(vec3a of)
{
	vec3 v = vec3(of);
	return max(v.x, max(v.y, v.z));
}

Walk walk_of(IN(Ray) ray, float side)
{
	vec3 d = ray.direction;
	vec3a ahead =
		vec3a(d.x >= 0.0f ? 1.0f : -1.0f, d.y >= 0.0f ? 1.0f : -1.0f, d.z >= 0.0f ? 1.0f : -1.0f);
	vec3a inverse = vec3a(inverse_of(d.x), inverse_of(d.y), inverse_of(d.z));
	Walk walk = { vec3a(ray.origin), vec3a(d), inverse, ahead, 0.5f * (ahead * ahead + ahead),
				  ivec3a(int(side) - 1) };
	return walk;
}

/* The cell at a distance, inside the octree. */
ivec3a cell_at(IN(Walk) walk, float t)
{
	return clamp(ivec3a(walk.origin + walk.direction * t), ivec3a(0), walk.last);
}

/* Distance to where the ray leaves a cell of a level, with `reach` more around it. */
float leaving(IN(Walk) walk, ivec3a cell, uint shift, uint reach)
{
	vec3a corner = vec3a(cell >> int(shift)) + walk.far + walk.ahead * float(reach);
	return smallest((corner * float(1u << shift) - walk.origin) * walk.inverse);
}

/* Goes on to the far side of the largest empty box that is known around the cell; in a leaf, of
 * that, unless it is hit. */
float look_around(IN(Ray) ray, IN(Walk) walk, ivec3a cell, float t, INOUT(Past) past,
				  INOUT(Hit) hit)
{
	uint entry = directory_entry(cell), shift;
	if (entry >> 31 == 0u) /* Nothing within entry - 1 cells around this one. */
		return leaving(walk, cell, depth - directory_level, entry > 1u ? entry - 1u : 0u);
	uint pointer = find_leaves(entry, cell, shift);
	if (pointer == 0u) /* An empty node of this level. */
		return leaving(walk, cell, shift, 0u);
	uvec2 tile = texelFetch(leaf_tile, int(pointer - 1u)).xy;
	uint octant = octant_of(cell, 0u);
	Stretch stretch = { vec3(vec3a(cell) + 0.5f),      GW_NONE, t,
						leaving(walk, cell, 0u, 0u), false,   false };
	if (holds_leaf(tile, octant))
		meet_leaf(ray, tile, octant, stretch, past, hit);
	return stretch.leave;
}

/* What a ray does that is still behind the surface it left when that should be behind it. */
void leave_start(IN(Passage) last, float t, INOUT(Hit) hit)
{
	if (hit.facet == GW_NONE && last.facet != GW_NONE && height_over(last, t) < 0.0f) {
		hit.facet = last.facet;
		hit.t = min(hit.t, last.leave);
	}
}

/*
 * The nearest facet whose front side the ray meets before t_max. Back sides let it through, because
 * planes that stick out over convex edges would darken what lies behind them, but passed_back_face
 * says that one was met first; with `both_sides` they stop the ray. Noise may put its start behind
 * the surface that it leaves, whose planes do not count there; but a ray that is still behind it at
 * a distance of GW_NEAR has gone into the rock.
 *
 * A ray that leaves the scene past surface that does not fill its cell may have slipped through
 * where facets of neighbouring cells do not meet. It is walked once more from the first such leaf
 * to the last, against the discs themselves.
 */
Hit trace_octree(IN(Ray) ray)
{
	Hit hit = { GW_NONE, ray.t_max, false };
	float side = float(1u << depth), nudge = 1e-5f + side * 4e-7f;
	Walk walk = walk_of(ray, side);
	float t = max(walk_start(), largest((side * (1.0f - walk.far) - walk.origin) * walk.inverse));
	float t_end = min(ray.t_max, smallest((side * walk.far - walk.origin) * walk.inverse));
	Past past = { { GW_NONE, ray.facing, 0.0f, 0.0f, 0.0f },
				  { GW_FAR, 0.0f, vec3(0.0f), vec3(0.0f), GW_FAR },
				  false };
	bool near_start = walk_start() < GW_NEAR;
	for (uint step = 0u; step < GW_WALK_STEPS && hit.facet == GW_NONE; step++) {
		if (past.again ? t > past.doubt.to : t >= t_end) {
			if (past.again || past.doubt.from >= t_end)
				break;
			past.again = true;
			t = past.doubt.from;
		}
		float next = look_around(ray, walk, cell_at(walk, t + nudge), t, past, hit);
		t = max(next, t + nudge);
		if (near_start && (t >= GW_NEAR || t >= t_end)) {
			near_start = false;
			leave_start(past.last, min(t_end, max(past.last.leave, GW_NEAR)), hit);
		}
	}
	return hit;
}

#endif
