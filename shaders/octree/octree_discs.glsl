/*
 * octree_discs.glsl - where in its cell a facet's plane is really covered by surface. Uses the
 * texel buffers facet_plane, leaf_fragment, fragment_surfel, surfel_place, surfel_facing,
 * surfel_disc and surfel_clip (octree.h); include it before octree_trace.glsl.
 *
 * A plane fills its cell, so alone it would end a surface a cell too far, and a shadow's edge with
 * it. The discs end where the surface does; inside a surface some eight of them cover each place.
 * Near an edge each is cut by its own guess of where the edge is, and a third of them decides: half
 * would end surfaces short, because discs cut off before this cell have no say in it. A disc that
 * is alone where eight should be has no say at all.
 *
 * Where discs lie all around a place and none that reaches it was cut, random points have left a
 * void in a surface that goes on.
 *
 * Planes and discs are flat, so over the crest of a bump they stick out by as much as a spacing,
 * and would shadow what the bump does not. There the nearest disc lies behind: see sticks_out.
 */
#ifndef OCTREE_DISCS_GLSL
#define OCTREE_DISCS_GLSL

#define TRACE_DISCS true

#include "base/sampling.glsl"
#include "octree/ray.glsl"
#include "octree/trace_constants.h"

/* Share of a disc that a cut leaves, by the cut's distance in radii; a cut without direction leaves
 * all. */
float share_left(vec2 direction, float distance)
{
	if (!(dot(direction, direction) > 0.0f))
		return 1.0f;
	float u = clamp(distance, -1.0f, 1.0f);
	return 1.0f - (acos(u) - u * sqrt(1.0f - u * u)) / GW_PI;
}

/* How much surface there is at each place of a disc: its area over that of what the cuts leave. */
float disc_density(vec4 size, vec4 clip)
{
	float left = share_left(size.zw, clip.x / size.x) + share_left(clip.yz, clip.w / size.x) - 1.0f;
	return size.y / (GW_PI * size.x * size.x * max(left, GW_SHARE_LEAST));
}

/* Is a fragment one of the facet's own discs? */
bool is_disc_of(uint slot, uint word)
{
	return word >> 31 == 0u && (word >> 30 & 1u) == (slot & 1u);
}

/* What a disc says about a place: its vote, and how much it adds to the cover; 0 where it does not
 * reach. */
int disc_vote(int surfel, vec3 at, INOUT(float) cover)
{
	vec4 size = texelFetch(surfel_disc, surfel);
	vec3 off = at - texelFetch(surfel_place, surfel).xyz;
	vec3 normal = texelFetch(surfel_facing, surfel).xyz, t, b;
	off -= normal * dot(normal, off);
	float radius = size.x + GW_DISC_OVERLAP;
	if (dot(off, off) > radius * radius)
		return 0;
	vec4 clip = texelFetch(surfel_clip, surfel);
	tangent_frame(normal, t, b);
	vec2 p = vec2(dot(t, off), dot(b, off));
	if (max(dot(size.zw, p) - clip.x, dot(clip.yz, p) - clip.w) > GW_DISC_OVERLAP)
		return -1;
	cover += disc_density(size, clip);
	return 2;
}

/* Do the facet's discs lie all around a place? */
bool is_surrounded(uint slot, vec3 at)
{
	vec2 way[4] = { vec2(1.0f, 0.0f), vec2(GW_SQRT_HALF, GW_SQRT_HALF), vec2(0.0f, 1.0f),
					vec2(-GW_SQRT_HALF, GW_SQRT_HALF) };
	uint seen = 0u, last = texelFetch(leaf_fragment, int(slot >> 1) + 1).x;
	vec3 t, b;
	tangent_frame(texelFetch(facet_plane, int(slot)).xyz, t, b);
	for (uint f = texelFetch(leaf_fragment, int(slot >> 1)).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(slot, word))
			continue;
		vec3 off = texelFetch(surfel_place, int(word & 0x3fffffffu)).xyz - at;
		vec2 p = vec2(dot(off, t), dot(off, b));
		for (int d = 0; d < 4; d++) {
			float along = dot(way[d], p);
			seen |= along > 0.0f ? 1u << d : along < 0.0f ? 16u << d : 0u;
		}
	}
	return bitCount(seen) >= GW_SEEN_AROUND;
}

/* Do the facet's discs lie on both sides of a place, along its crease with a surface of a normal?
 * At the free end of a wall they lie on one. */
bool is_along_crease(uint slot, vec3 other, vec3 at)
{
	vec3 crease = cross(texelFetch(facet_plane, int(slot)).xyz, other);
	uint last = texelFetch(leaf_fragment, int(slot >> 1) + 1).x;
	bool before = false, after = false;
	for (uint f = texelFetch(leaf_fragment, int(slot >> 1)).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(slot, word))
			continue;
		float along = dot(crease, texelFetch(surfel_place, int(word & 0x3fffffffu)).xyz - at);
		before = before || along < 0.0f;
		after = after || along > 0.0f;
	}
	return before && after;
}

/*
 * Does a place on a plane lie where the surface has bent away beneath it? So it is when of all the
 * leaf's discs the nearest one has it in front, and lies behind the plane: one that faces about as
 * the plane does, or meets it as the sides of a block do, each behind the other. A floor that goes
 * on beneath a block is neither.
 *   middle   of what the plane is the surface of
 */
bool sticks_out(uint leaf, vec3 normal, vec3 middle, vec3 at)
{
	float on = GW_FAR, behind = GW_FAR; /* squared distances of the nearest */
	uint last = texelFetch(leaf_fragment, int(leaf) + 1).x;
	for (uint f = texelFetch(leaf_fragment, int(leaf)).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (word >> 31 != 0u)
			continue;
		int surfel = int(word & 0x3fffffffu);
		vec3 place = texelFetch(surfel_place, surfel).xyz, off = at - place;
		vec3 facing = texelFetch(surfel_facing, surfel).xyz;
		float rise = GW_STICK_OUT * texelFetch(surfel_disc, surfel).x;
		bool beneath = dot(normal, off) >= 0.0f && dot(facing, off) > rise &&
					   (dot(facing, normal) > GW_LIKE_COSINE ||
						dot(facing, middle - place) <= GW_CONCAVE_DOUBT);
		if (beneath)
			behind = min(behind, dot(off, off));
		else
			on = min(on, dot(off, off));
	}
	return behind < on;
}

bool is_covered(uint slot, vec3 at)
{
	uint first = texelFetch(leaf_fragment, int(slot >> 1)).x;
	uint last = texelFetch(leaf_fragment, int(slot >> 1) + 1).x;
	if (last - first > GW_DISC_FRAGMENTS)
		return true;
	vec3 normal = texelFetch(facet_plane, int(slot)).xyz;
	if (sticks_out(slot >> 1, normal, texelFetch(facet_centre, int(slot)).xyz, at))
		return false;
	int votes = 0;
	float cover = 0.0f;
	bool cut = false;
	for (uint f = first; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(slot, word))
			continue;
		int vote = disc_vote(int(word & 0x3fffffffu), at, cover);
		votes += vote;
		cut = cut || vote < 0;
	}
	return (votes > 0 && cover > GW_COVER_LEAST) || (!cut && is_surrounded(slot, at));
}

#include "octree/octree_disc_hits.glsl"

#endif
