/*
 * octree_disc_hits.glsl - rays that the planes let out of the scene, against the discs of a leaf
 * themselves. Part of octree_discs.glsl.
 *
 * Planes of neighbouring cells do not meet, and where two surfaces do, in creases and corners, one
 * of them may have no fragment in a cell. A disc has no cells: it stops the ray wherever that
 * passes it. But random points leave voids, where no disc reaches, and in a crease each disc is cut
 * by its own guess. So beyond its rim or its cut a disc stops a ray where that goes into rock for
 * certain: behind another surface, past two that meet as a floor and a wall do, or amid others
 * none of which was cut there. Over a convex edge or a free one nothing of that holds. And within
 * its rim a disc does not stop a ray where most of its cell's were cut: it sticks out over a hole.
 * Behind what lets light through there is no rock.
 */
#ifndef OCTREE_DISC_HITS_GLSL
#define OCTREE_DISC_HITS_GLSL

#include "octree/opacity.glsl"

/* Where a ray passes the plane of a disc, from in front. */
struct DiscPassage {
	vec3 place, normal; /* of the disc */
	vec3 at;
	float t;
	float squared; /* distance from its centre, radii^2 */
	bool cut;
};

bool is_cut_off(int surfel, vec3 normal, vec3 off, vec4 size)
{
	vec4 clip = texelFetch(surfel_clip, surfel);
	vec3 t, b;
	tangent_frame(normal, t, b);
	vec2 p = vec2(dot(t, off), dot(b, off));
	return max(dot(size.zw, p) - clip.x, dot(clip.yz, p) - clip.w) > GW_DISC_OVERLAP;
}

/* Near its start a ray does not meet discs of the surface that it leaves, nor of that one's other
 * side: those that hardly rise over it, and of a surface across it those that the start does not
 * lie in front of either. */
bool is_of_start(IN(Ray) ray, vec3 place, vec3 normal, float height)
{
	float alike = dot(normal, ray.facing), rise = dot(ray.facing, place - ray.foot);
	if (abs(alike) > GW_LIKE_COSINE)
		return rise < GW_NEAR_HEIGHT * max(alike, -GW_LIKE_OTHER * alike);
	return rise < GW_NEAR_HEIGHT * GW_LIKE_LEAST && height < GW_NEAR_HEIGHT;
}

bool passes_disc(int surfel, IN(Ray) ray, float t_max, OUT(DiscPassage) passage)
{
	passage.place = texelFetch(surfel_place, surfel).xyz;
	passage.normal = texelFetch(surfel_facing, surfel).xyz;
	float approach = dot(passage.normal, ray.direction);
	if (approach > -1e-6f)
		return false;
	vec3 off = ray.origin - passage.place;
	float height = dot(passage.normal, off);
	passage.t = -height / approach;
	if (!(passage.t >= 0.0f && passage.t < t_max))
		return false;
	if (is_passed(ray, passage.normal, passage.t))
		return false;
	vec4 size = texelFetch(surfel_disc, surfel);
	passage.at = ray.origin + ray.direction * passage.t;
	off += ray.direction * passage.t;
	passage.squared = dot(off, off) / (size.x * size.x);
	if (passage.squared > GW_CORNER_REACH_SQUARED ||
		(passage.t < GW_NEAR && is_of_start(ray, passage.place, passage.normal, height)))
		return false;
	passage.cut = is_cut_off(surfel, passage.normal, off, size);
	return true;
}

/* Do two discs lie as a floor and a wall do? */
bool lie_concave(vec3 place, vec3 normal, vec3 other_place, vec3 other_normal)
{
	vec3 apart = other_place - place;
	return dot(normal, other_normal) < GW_ACROSS_COSINE && dot(apart, normal) > -GW_CONCAVE_DOUBT &&
		   dot(apart, other_normal) < GW_CONCAVE_DOUBT;
}

/* What the leaf's discs say of a place beyond a disc: that it lies behind one of a surface across,
 * or that the disc's own surface does not end before it. */
bool is_in_rock(IN(Owner) first, IN(DiscPassage) passage, bool amid)
{
	bool on = amid;
	uint leaf = leaf_of(first.word), last = texelFetch(leaf_fragment, int(leaf) + 1).x;
	for (uint f = texelFetch(leaf_fragment, int(leaf)).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (word >> 31 != 0u || stops_from_behind(owner_joined(first, word).facet))
			continue;
		int surfel = int(word & GW_FRAGMENT_SURFEL);
		vec3 place = texelFetch(surfel_place, surfel).xyz, off = passage.at - place;
		vec3 normal = texelFetch(surfel_facing, surfel).xyz;
		vec4 size = texelFetch(surfel_disc, surfel);
		if (dot(off, off) < GW_VOID_REACH_SQUARED * size.x * size.x && dot(off, normal) <= 0.0f &&
			lie_concave(passage.place, passage.normal, place, normal))
			return true;
		on = on && !(dot(normal, passage.normal) > GW_LIKE_COSINE &&
					 is_cut_off(surfel, normal, off, size));
	}
	return on;
}

/* Is the place within the leaf's cell, or are discs all around it? */
bool is_amid(IN(Owner) owner, vec3 cell_centre, vec3 at)
{
	vec3 off = at - cell_centre;
	return max(abs(off.x), max(abs(off.y), abs(off.z))) <= 0.5f || is_surrounded(owner, at);
}

/* The discs of a leaf, of which that is the first facet; see above. A light's or a record's own
 * surface is not met near t_max. */
void meet_discs(IN(Ray) ray, uint facet, vec3 cell_centre, INOUT(Doubt) doubt, INOUT(Hit) hit)
{
	Owner first = owner_of(facet);
	uint leaf = leaf_of(first.word), last = texelFetch(leaf_fragment, int(leaf) + 1).x;
	for (uint f = texelFetch(leaf_fragment, int(leaf)).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		Owner own = owner_joined(first, word);
		DiscPassage passage;
		if (word >> 31 != 0u || is_foliage(own.facet) ||
			!passes_disc(int(word & GW_FRAGMENT_SURFEL), ray, min(hit.t, ray.t_max - GW_NEAR),
						 passage))
			continue;
		bool met = abs(doubt.t - passage.t) < GW_NEAR &&
				   lie_concave(doubt.place, doubt.normal, passage.place, passage.normal);
		if (!met && passage.squared < GW_VOID_REACH_SQUARED) {
			bool amid = !passage.cut && (passage.squared <= 1.0f
											 ? is_covered(own, passage.at)
											 : is_amid(own, cell_centre, passage.at));
			met = is_in_rock(first, passage,
							 amid && !passes_crest(ray, leaf, passage.t, passage.normal,
												   passage.place));
		}
		if (met) {
			hit.t = passage.t;
			hit.facet = own.facet;
		} else if (!stops_from_behind(own.facet)) {
			doubt.t = passage.t;
			doubt.place = passage.place;
			doubt.normal = passage.normal;
		}
	}
}

#endif
