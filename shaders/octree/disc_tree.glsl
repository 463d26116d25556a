/*
 * disc_tree.glsl - rays against the tree of large discs (lib/normals/disc_tree.h). Uses the
 * texel buffer disc_tree.
 */
#ifndef DISC_TREE_GLSL
#define DISC_TREE_GLSL

#include "octree/opacity.glsl"
#include "base/sampling.glsl"
#include "octree/trace_constants.h"

/* See gw_disc_hit. */
struct DiscHit {
	uint disc, facet; /* GW_NONE when nothing is hit */
	float t, yields, nearest_back_face;
};

/* Where a ray meets a disc. */
struct DiscMeeting {
	float t;
	float approach; /* how fast it comes nearer to the front; above 0: from behind */
	float yields;
};

/* Where the ray enters and leaves the boxes of a node's children, from 0 to t; it misses those that
 * it would leave before. */
void pass_boxes(int node, vec3 origin, vec3 inverse, float t, OUT(vec4a) enter, OUT(vec4a) leave)
{
	vec4a a = (vec4a(uintBitsToFloat(texelFetch(disc_tree, node))) - origin.x) * inverse.x;
	vec4a b = (vec4a(uintBitsToFloat(texelFetch(disc_tree, node + 1))) - origin.x) * inverse.x;
	enter = max(min(a, b), vec4a(0.0f));
	leave = min(max(a, b), vec4a(t));
	a = (vec4a(uintBitsToFloat(texelFetch(disc_tree, node + 2))) - origin.y) * inverse.y;
	b = (vec4a(uintBitsToFloat(texelFetch(disc_tree, node + 3))) - origin.y) * inverse.y;
	enter = max(min(a, b), enter);
	leave = min(max(a, b), leave);
	a = (vec4a(uintBitsToFloat(texelFetch(disc_tree, node + 4))) - origin.z) * inverse.z;
	b = (vec4a(uintBitsToFloat(texelFetch(disc_tree, node + 5))) - origin.z) * inverse.z;
	enter = max(min(a, b), enter);
	leave = min(max(a, b), leave);
}

/* The second derivative of a disc's height along two directions in its plane. */
float bent(vec3 bend, vec2 a, vec2 b)
{
	return bend.x * a.x * b.x + bend.y * (a.x * b.y + a.y * b.x) + bend.z * a.y * b.y;
}

/* Where a ray meets a disc. From the ray's place nearest to the centre on, so that rounding does
 * not depend on how far away the ray starts: the height over the bent disc is
 * height + first s + second s^2 there. */
bool meets_disc(int disc, vec4 place, vec3 normal, IN(Ray) ray, OUT(DiscMeeting) m)
{
	vec3 off = ray.origin - place.xyz, tangent, bitangent;
	float radius = place.w, start = -dot(off, ray.direction);
	off += ray.direction * start;
	if (dot(off, off) > GW_DISC_REACH_SQUARED * radius * radius)
		return false;
	vec3 bend = uintBitsToFloat(texelFetch(disc_tree, disc + 4).xyz);
	tangent_frame(normal, tangent, bitangent);
	vec2 p = vec2(dot(tangent, off), dot(bitangent, off));
	vec2 w = vec2(dot(tangent, ray.direction), dot(bitangent, ray.direction));
	float second = -0.5f * bent(bend, w, w);
	float first = dot(normal, ray.direction) - bent(bend, p, w);
	float height = dot(normal, off) - 0.5f * bent(bend, p, p);
	float root = first * first - 4.0f * second * height;
	if (!(root >= 0.0f))
		return false;
	root = first < 0.0f ? first - sqrt(root) : first + sqrt(root);
	if (abs(root) < 1e-6f)
		return false;
	float s = -2.0f * height / root;
	p += w * s;
	m.t = start + s;
	m.approach = first + 2.0f * second * s;
	float dish = GW_DISC_DISH * dot(p, p) / radius + GW_DISC_YIELD * radius;
	m.yields = m.t + dish / max(abs(m.approach), GW_DISC_GRAZING);
	vec3 cut = uintBitsToFloat(texelFetch(disc_tree, disc + 2).xyz);
	vec3 other = uintBitsToFloat(texelFetch(disc_tree, disc + 3).xyz);
	float over = max(cut.x * p.x + cut.y * p.y - cut.z, other.x * p.x + other.y * p.y - other.z);
	return dot(p, p) <= radius * radius && over <= GW_CUT_OVERLAP * radius;
}

/* Is a disc so near to the start of the ray one of the surface that the ray leaves? */
bool is_own_disc(vec4 place, vec3 normal, IN(Ray) ray, float approach)
{
	float alike = dot(normal, ray.facing), height = dot(ray.facing, place.xyz - ray.foot);
	return approach > 0.0f || height < GW_DISC_HEIGHT * place.w * max(alike, GW_LIKE_LEAST);
}

/* The disc of a leaf. */
void hit_disc(int disc, IN(Ray) ray, INOUT(DiscHit) hit)
{
	vec4 place = uintBitsToFloat(texelFetch(disc_tree, disc));
	uvec4 facing = texelFetch(disc_tree, disc + 1);
	vec3 normal = uintBitsToFloat(facing.xyz);
	DiscMeeting m;
	if (!meets_disc(disc, place, normal, ray, m) || m.t < 0.0f || m.t >= ray.t_max)
		return;
	if (m.t < GW_DISC_NEAR * place.w && is_own_disc(place, normal, ray, m.approach))
		return;
	if (is_passed(ray, normal, m.t))
		return;
	if (m.approach > 0.0f && !stops_from_behind(facing.w)) {
		hit.nearest_back_face = min(hit.nearest_back_face, m.t);
		if (!ray.both_sides)
			return;
	}
	uint number = texelFetch(disc_tree, disc + 2).w;
	if (hit.disc != GW_NONE &&
		(m.yields > hit.yields || (m.yields == hit.yields && number > hit.disc)))
		return;
	hit.t = m.t;
	hit.yields = m.yields;
	hit.facet = facing.w;
	hit.disc = number;
}

/* The nearest disc that the ray meets before t_max; see gw_disc_tree_trace. Of a node's children
 * the one that the ray enters first comes next, and the others wait. */
DiscHit trace_discs(IN(Ray) ray)
{
	DiscHit hit = { GW_NONE, GW_NONE, ray.t_max, ray.t_max, ray.t_max };
	vec3 d = ray.direction, inverse = vec3(inverse_of(d.x), inverse_of(d.y), inverse_of(d.z));
	uvec4 header = texelFetch(disc_tree, 0);
	int first = int(1u + GW_DISC_TEXELS * header.y);
	uint waiting[GW_DISC_WAITING], count = 0u, at = header.x > 0u ? 0u : GW_NONE;
	float waiting_enter[GW_DISC_WAITING];
	for (uint step = 0u; step < GW_DISC_STEPS && at != GW_NONE; step++) {
		int node = first + int(GW_DISC_NODE_TEXELS * at);
		uvec4 children = texelFetch(disc_tree, node + 6);
		vec4a enter, leave;
		pass_boxes(node, ray.origin, inverse, hit.yields, enter, leave);
		float nearest = GW_FAR;
		at = GW_NONE;
		for (int k = 0; k < 4; k++) {
			uint child = children[k];
			float from = enter[k];
			if (!(from <= leave[k]))
				continue;
			if (child >= GW_DISC_LEAF) {
				if (child != GW_NONE)
					hit_disc(int(child - GW_DISC_LEAF), ray, hit);
				continue;
			}
			bool nearer = at == GW_NONE || from < nearest;
			uint other = nearer ? at : child;
			float other_enter = nearer ? nearest : from;
			at = nearer ? child : at;
			nearest = nearer ? from : nearest;
			if (other == GW_NONE || count == GW_DISC_WAITING)
				continue;
			waiting[count] = other;
			waiting_enter[count] = other_enter;
			count++;
		}
		while (at == GW_NONE && count > 0u) {
			count--;
			at = waiting_enter[count] <= hit.yields ? waiting[count] : GW_NONE;
		}
	}
	return hit;
}

#endif
