/*
 * octree_discs.glsl - where in its cell a facet's plane is really covered by surface. Uses the
 * texel buffers facet_plane, leaf_fragment, fragment_surfel, surfel_place, surfel_facing,
 * surfel_disc and surfel_clip (octree.h), and facet_leaf as a storage buffer, since there are
 * devices that take no more textures; include it before octree_trace.glsl.
 *
 * A plane fills its cell, so alone it would end a surface a cell too far, and a shadow's edge with
 * it. The discs end where the surface does; inside a surface some eight of them cover each place.
 * Near an edge each is cut by its own guess of where the edge is, and a third of them decides: half
 * would end surfaces short, because discs cut off before this cell have no say in it. A disc that
 * is alone where eight should be has no say at all.
 *
 * Where discs lie all around a place and none that reaches it was cut, random points have left a
 * void in a surface that goes on.
 */
#ifndef OCTREE_DISCS_GLSL
#define OCTREE_DISCS_GLSL

#define TRACE_DISCS true

#include "base/sampling.glsl"
#include "octree/octree_numbers.glsl"
#include "octree/ray.glsl"
#include "octree/trace_constants.h"
#include "octree/octree_crests.glsl"

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

Owner owner_of(uint facet)
{
	Owner owner = { facet, facet_leaf[facet] };
	return owner;
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
bool is_surrounded(IN(Owner) owner, vec3 at)
{
	vec2 way[4] = { vec2(1.0f, 0.0f), vec2(GW_SQRT_HALF, GW_SQRT_HALF), vec2(0.0f, 1.0f),
					vec2(-GW_SQRT_HALF, GW_SQRT_HALF) };
	uint seen = 0u, last = texelFetch(leaf_fragment, int(leaf_of(owner.word)) + 1).x;
	vec3 t, b;
	tangent_frame(texelFetch(facet_plane, int(owner.facet)).xyz, t, b);
	for (uint f = texelFetch(leaf_fragment, int(leaf_of(owner.word))).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(owner.word, word))
			continue;
		vec3 off = texelFetch(surfel_place, int(word & GW_FRAGMENT_SURFEL)).xyz - at;
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
bool is_along_crease(IN(Owner) owner, vec3 other, vec3 at)
{
	vec3 crease = cross(texelFetch(facet_plane, int(owner.facet)).xyz, other);
	uint last = texelFetch(leaf_fragment, int(leaf_of(owner.word)) + 1).x;
	bool before = false, after = false;
	for (uint f = texelFetch(leaf_fragment, int(leaf_of(owner.word))).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(owner.word, word))
			continue;
		int surfel = int(word & GW_FRAGMENT_SURFEL);
		float along = dot(crease, texelFetch(surfel_place, surfel).xyz - at);
		before = before || along < 0.0f;
		after = after || along > 0.0f;
	}
	return before && after;
}

bool is_covered(IN(Owner) owner, vec3 at)
{
	uint first = texelFetch(leaf_fragment, int(leaf_of(owner.word))).x;
	uint last = texelFetch(leaf_fragment, int(leaf_of(owner.word)) + 1).x;
	if (last - first > GW_DISC_FRAGMENTS)
		return true;
	int votes = 0;
	float cover = 0.0f;
	bool cut = false;
	for (uint f = first; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(owner.word, word))
			continue;
		int vote = disc_vote(int(word & GW_FRAGMENT_SURFEL), at, cover);
		votes += vote;
		cut = cut || vote < 0;
	}
	return (votes > 0 && cover > GW_COVER_LEAST) || (!cut && is_surrounded(owner, at));
}

#include "octree/octree_disc_hits.glsl"

#endif
