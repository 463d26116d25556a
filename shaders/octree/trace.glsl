/*
 * trace.glsl - rays through the octree and the tree of its large discs, which is how scenes are
 * traced.
 */
#ifndef TRACE_GLSL
#define TRACE_GLSL

#include "octree/octree_trace.glsl"
#include "octree/disc_tree.glsl"

/* Whether the tree holds anything: mostly it does not, and costs nothing. */
CONSTANT(4, uint, has_discs, 0u);

#ifdef TRACE_OPACITY

/*
 * The facet whose light a ray finds that has met another one at a place. Planes reach beyond their
 * cells, so that a ray that comes flat meets that of a cell before the one where it gets to the
 * surface; were its light taken, all light would lie half a cell nearer than it does. So it is that
 * of the cell around the place, if surface that faces alike passes near the place there.
 */
uint facet_around(uint met, vec3 at)
{
	LeafAround leaf;
	if (!find_leaf_around(at, leaf))
		return met;
	uint found = met, first = first_facet(leaf.tile, leaf.octant);
	uint last = first + (has_second(leaf.tile, leaf.octant) ? 1u : 0u);
	if ((met >= first && met <= last) || is_foliage(met))
		return met;
	vec3 normal = texelFetch(facet_plane, int(met)).xyz, off = at - (floor(at) + 0.5f);
	float nearest = GW_NOISE_DEPTH;
	for (uint facet = first; facet <= last; facet++) {
		vec4 plane = texelFetch(facet_plane, int(facet));
		float height = abs(dot(plane.xyz, off) - plane.w);
		if (dot(plane.xyz, normal) <= GW_LIKE_COSINE || height >= nearest || is_foliage(facet) ||
			texelFetch(facet_centre, int(facet)).w <= 0.0f)
			continue;
		nearest = height;
		found = facet;
	}
	return found;
}

#endif

/* The nearest facet that the ray meets, or GW_NONE. Where both have the surface that is hit, the
 * octree's is the finer one. */
Hit trace(IN(Ray) ray)
{
	DiscHit disc = { GW_NONE, GW_NONE, ray.t_max, ray.t_max, ray.t_max };
	if (has_discs != 0u)
		disc = trace_discs(ray);
	Ray nearer = ray;
	nearer.t_max = min(disc.yields, ray.t_max);
	Hit hit = trace_octree(nearer);
	if (hit.facet == GW_NONE) {
		hit.facet = disc.facet;
		hit.t = disc.t;
	}
#ifdef TRACE_OPACITY
	else
		hit.facet = facet_around(hit.facet, ray.origin + ray.direction * hit.t);
#endif
	hit.passed_back_face = hit.passed_back_face || disc.nearest_back_face < hit.t;
	return hit;
}

#ifdef TRACE_OPACITY

/*
 * The same, attenuated by what lets light through. The ray ends where no more than `until` of it
 * would be left: at a random number below 1 it ends at each surface as often as that stops light,
 * and at GW_THROUGH_LEAST at what nothing passes. `through` receives how much of it gets to where
 * it ends. A surface that is passed is met from both sides; its back, if it has one, is dark. That
 * of what is opaque is met by rays alone that have slipped through it, as where all is opaque.
 */
Hit trace_through(IN(Ray) ray, float until, OUT(float) through)
{
	passed_t = -1.0f;
	through = ray_left = 1.0f;
	ray_until = until;
	stopped_by_foliage = false;
	Hit hit;
	bool back = false;
	for (uint sheet = 0u;; sheet++) {
		hit = trace(ray);
		back = back || hit.passed_back_face;
		if (dark_facet == 0u || sheet == GW_SHEETS_MOST || hit.facet == GW_NONE ||
			stopped_by_foliage)
			break;
		float left = ray_left * transparency_of(hit.facet);
		if (left <= until)
			break;
		ray_left = left;
		pass_sheet(hit);
	}
	hit.passed_back_face = back;
	through = ray_left;
	if (dark_facet == 0u || hit.facet == GW_NONE || ray.both_sides)
		return hit;
	vec4 plane = texelFetch(facet_plane, int(hit.facet));
	if (dot(plane.xyz, ray.direction) > 0.0f && stops_from_behind(hit.facet) &&
		!is_two_sided(hit.facet))
		hit.facet = dark_facet - 1u;
	return hit;
}

#endif

#endif
