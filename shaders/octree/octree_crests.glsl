/*
 * octree_crests.glsl - rays over the crests of bumps. Part of octree_discs.glsl.
 *
 * Planes and discs are flat, so over a crest they stick out by as much as a spacing, and would
 * shadow what the bump does not. There the nearest disc lies behind; it may have no fragment in the
 * leaf itself, where nothing but what sticks out has any.
 */
#ifndef OCTREE_CRESTS_GLSL
#define OCTREE_CRESTS_GLSL

#include "octree/octree_leaf.glsl"
#include "octree/octree_layout.h"

/* A place on a plane of a normal, which is that of the surface around its middle. */
struct PlanePlace {
	vec3 at, normal, middle;
};

/*
 * Has a disc a place in front, as where its surface has bent away beneath a plane? It lies behind
 * the plane and faces about as that does, or meets it as the sides of a block do, each behind the
 * other. A floor that goes on beneath a block is neither.
 */
bool lies_beneath(IN(PlanePlace) on, vec3 facing, vec3 place, float radius)
{
	vec3 off = on.at - place;
	return dot(on.normal, off) >= 0.0f && dot(facing, off) > GW_STICK_OUT * radius &&
		   (dot(facing, on.normal) > GW_LIKE_COSINE ||
			dot(facing, on.middle - place) <= GW_CONCAVE_DOUBT);
}

/* Does a ray that is off a disc's middle at a distance meet the inner part of the disc before or
 * after? Near its start it leaves its own. */
bool meets_inner_part(IN(Ray) ray, float t, vec3 off, vec3 facing, float radius)
{
	float approach = dot(facing, ray.direction);
	float ahead = dot(facing, off) / (abs(approach) > 1e-6f ? -approach : 1e-6f);
	vec3 there = off + ray.direction * ahead;
	return t + ahead > GW_NEAR && dot(there, there) < GW_INNER_SQUARED * radius * radius;
}

/* The number of the leaf around a place, or GW_NONE. */
uint leaf_around(vec3 at)
{
	LeafAround leaf;
	if (!find_leaf_around(at, leaf))
		return GW_NONE;
	return leaf_of(facet_leaf[first_facet(leaf.tile, leaf.octant)]);
}

/* Does a ray pass a place on a plane of a leaf above surface that has bent away beneath it? */
bool passes_crest(IN(Ray) ray, uint leaf, float t, vec3 normal, vec3 middle)
{
	PlanePlace on = { ray.origin + ray.direction * t, normal, middle };
	float nearest = GW_FAR; /* squared distance */
	bool passes = false;
	uint beneath = leaf_around(on.at - normal * GW_BENEATH);
	uint leaves = beneath == GW_NONE || beneath == leaf ? 1u : 2u;
	for (uint k = 0u; k < leaves; k++) {
		uint in_leaf = k == 0u ? leaf : beneath;
		uint last = texelFetch(leaf_fragment, int(in_leaf) + 1).x;
		for (uint f = texelFetch(leaf_fragment, int(in_leaf)).x; f < last; f++) {
			uint word = texelFetch(fragment_surfel, int(f)).x;
			int surfel = int(word & GW_FRAGMENT_SURFEL);
			vec3 place = texelFetch(surfel_place, surfel).xyz, off = on.at - place;
			float squared = dot(off, off);
			if (word >> 31 != 0u || squared >= nearest)
				continue;
			vec3 facing = texelFetch(surfel_facing, surfel).xyz;
			float radius = texelFetch(surfel_disc, surfel).x;
			nearest = squared;
			passes = lies_beneath(on, facing, place, radius) &&
					 !meets_inner_part(ray, t, off, facing, radius);
		}
	}
	return passes;
}

#endif
