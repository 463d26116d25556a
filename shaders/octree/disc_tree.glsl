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

/* Does the ray pass the box of a node before t? */
bool meets_box(uvec4 low_texel, uvec4 high_texel, vec3 origin, vec3 inverse, float t)
{
	vec3 a = (uintBitsToFloat(low_texel.xyz) - origin) * inverse;
	vec3 b = (uintBitsToFloat(high_texel.xyz) - origin) * inverse;
	vec3 near = min(a, b), far = max(a, b);
	float enter = max(near.x, max(near.y, near.z)), leave = min(far.x, min(far.y, far.z));
	return max(enter, 0.0f) <= min(leave, t);
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
	if (hit.disc != GW_NONE && m.yields >= hit.yields)
		return;
	hit.t = m.t;
	hit.yields = m.yields;
	hit.facet = facing.w;
	hit.disc = texelFetch(disc_tree, disc + 2).w;
}

/* The nearest disc that the ray meets before t_max; see gw_disc_tree_trace. */
DiscHit trace_discs(IN(Ray) ray)
{
	DiscHit hit = { GW_NONE, GW_NONE, ray.t_max, ray.t_max, ray.t_max };
	vec3 d = ray.direction;
	vec3 inverse = vec3(inverse_of(d.x), inverse_of(d.y), inverse_of(d.z));
	uint nodes = texelFetch(disc_tree, 0).x, at = 0u;
	for (uint step = 0u; step < GW_DISC_STEPS && at < nodes; step++) {
		uvec4 low = texelFetch(disc_tree, int(1u + 2u * at));
		uvec4 high = texelFetch(disc_tree, int(2u + 2u * at));
		if (!meets_box(low, high, ray.origin, inverse, hit.yields)) {
			at = low.w;
			continue;
		}
		at++;
		if (high.w != GW_NONE)
			hit_disc(int(high.w), ray, hit);
	}
	return hit;
}

#endif
