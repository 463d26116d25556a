/*
 * octree_discs.glsl - where in its cell a lobe's plane is really covered by surface. Uses the texel
 * buffers lobe_plane, leaf_fragment, fragment_surfel, surfel_place, surfel_facing, surfel_disc and
 * surfel_clip (octree.h); include it before octree_trace.glsl.
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

#define TRACE_DISCS

#include "base/sampling.glsl"
#include "octree/trace_constants.h"

/* Share of a disc that a cut leaves, by the cut's distance in radii; a cut without direction leaves
 * all. */
float share_left(vec2 direction, float distance)
{
	float u = clamp(distance, -1.0, 1.0);
	return dot(direction, direction) > 0.0 ? 1.0 - (acos(u) - u * sqrt(1.0 - u * u)) / PI : 1.0;
}

/* How much surface there is at each place of a disc: its area over that of what the cuts leave. */
float disc_density(vec4 size, vec4 clip)
{
	float left = share_left(size.zw, clip.x / size.x) + share_left(clip.yz, clip.w / size.x) - 1.0;
	return size.y / (PI * size.x * size.x * max(left, GW_SHARE_LEAST));
}

/* Do the lobe's discs lie all around a place? */
bool is_surrounded(int slot, vec3 at)
{
	const vec2 way[4] = vec2[4](vec2(1.0, 0.0), vec2(GW_SQRT_HALF), vec2(0.0, 1.0),
								vec2(-GW_SQRT_HALF, GW_SQRT_HALF));
	uint seen = 0u, last = texelFetch(leaf_fragment, (slot >> 1) + 1).x;
	vec3 t, b;
	tangent_frame(texelFetch(lobe_plane, slot).xyz, t, b);
	for (uint f = texelFetch(leaf_fragment, slot >> 1).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if ((word >> 31) != 0u || ((word >> 30) & 1u) != uint(slot & 1))
			continue;
		vec3 off = texelFetch(surfel_place, int(word & 0x3fffffffu)).xyz - at;
		vec2 p = vec2(dot(off, t), dot(off, b));
		for (int d = 0; d < 4; d++) {
			float along = dot(way[d], p);
			seen |= along > 0.0 ? 1u << d : along < 0.0 ? 16u << d : 0u;
		}
	}
	return bitCount(seen) >= GW_SEEN_AROUND;
}

/* Do the lobe's discs lie on both sides of a place, along its crease with a surface of a normal?
 * At the free end of a wall they lie on one. */
bool is_along_crease(int slot, vec3 other, vec3 at)
{
	vec3 crease = cross(texelFetch(lobe_plane, slot).xyz, other);
	uint last = texelFetch(leaf_fragment, (slot >> 1) + 1).x;
	bool before = false, after = false;
	for (uint f = texelFetch(leaf_fragment, slot >> 1).x; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if ((word >> 31) != 0u || ((word >> 30) & 1u) != uint(slot & 1))
			continue;
		float along = dot(crease, texelFetch(surfel_place, int(word & 0x3fffffffu)).xyz - at);
		before = before || along < 0.0;
		after = after || along > 0.0;
	}
	return before && after;
}

bool is_covered(int slot, vec3 at)
{
	uint first = texelFetch(leaf_fragment, slot >> 1).x;
	uint last = texelFetch(leaf_fragment, (slot >> 1) + 1).x;
	if (last - first > GW_DISC_FRAGMENTS)
		return true;
	int votes = 0;
	float cover = 0.0;
	bool cut = false;
	for (uint f = first; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if ((word >> 31) != 0u || ((word >> 30) & 1u) != uint(slot & 1))
			continue;
		int surfel = int(word & 0x3fffffffu);
		vec4 size = texelFetch(surfel_disc, surfel);
		vec3 off = at - texelFetch(surfel_place, surfel).xyz;
		vec3 normal = texelFetch(surfel_facing, surfel).xyz, t, b;
		off -= normal * dot(normal, off);
		float radius = size.x + GW_DISC_SLACK;
		if (dot(off, off) > radius * radius)
			continue;
		vec4 clip = texelFetch(surfel_clip, surfel);
		tangent_frame(normal, t, b);
		vec2 p = vec2(dot(t, off), dot(b, off));
		vec2 over = vec2(dot(size.zw, p) - clip.x, dot(clip.yz, p) - clip.w);
		bool kept = max(over.x, over.y) <= GW_DISC_SLACK;
		votes += kept ? 2 : -1;
		cut = cut || !kept;
		cover += kept ? disc_density(size, clip) : 0.0;
	}
	return (votes > 0 && cover > GW_COVER_LEAST) || (!cut && is_surrounded(slot, at));
}

#endif
