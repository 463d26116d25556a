/*
 * disc_tree.glsl - rays through the octree and the tree of its large discs, which is how scenes are
 * traced. Uses the texel buffer disc_tree (lib/surfels/disc_tree.h); include it after
 * octree_trace.glsl.
 * gw_disc_tree_trace does the same, step by step.
 */
#ifndef DISC_TREE_GLSL
#define DISC_TREE_GLSL

#include "base/sampling.glsl"

/* Whether the tree holds anything: mostly it does not, and costs nothing. */
layout(constant_id = 4) const uint has_discs = 0u;

struct DiscRay {
	vec3 origin, direction, inverse;
	vec4 tangent_plane;
	float t_max;
	bool both_sides;
};

/* lobe is GW_NONE when nothing is hit; see gw_disc_hit. */
struct DiscHit {
	uint lobe;
	float t, yields, behind;
};

struct DiscMeeting {
	float t, approach, yields;
};

bool meets_box(uvec4 low_texel, uvec4 high_texel, DiscRay ray, float t)
{
	vec3 a = (uintBitsToFloat(low_texel.xyz) - ray.origin) * ray.inverse;
	vec3 b = (uintBitsToFloat(high_texel.xyz) - ray.origin) * ray.inverse;
	vec3 near = min(a, b), far = max(a, b);
	float enter = max(near.x, max(near.y, near.z)), leave = min(far.x, min(far.y, far.z));
	return max(enter, 0.0) <= min(leave, t);
}

/* The second derivative of a disc's height along two directions in its plane. */
float bent(vec3 bend, vec2 a, vec2 b)
{
	return bend.x * a.x * b.x + bend.y * (a.x * b.y + a.y * b.x) + bend.z * a.y * b.y;
}

/* Where a ray meets a disc, from the ray's place nearest to the centre on: the height over the bent
 * disc is height + first s + second s^2 there. */
bool meets_disc(int disc, vec4 place, vec3 normal, DiscRay ray, out DiscMeeting m)
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
	float second = -0.5 * bent(bend, w, w);
	float first = dot(normal, ray.direction) - bent(bend, p, w);
	float height = dot(normal, off) - 0.5 * bent(bend, p, p);
	float root = first * first - 4.0 * second * height;
	if (!(root >= 0.0))
		return false;
	root = first < 0.0 ? first - sqrt(root) : first + sqrt(root);
	if (abs(root) < 1e-6)
		return false;
	float s = -2.0 * height / root;
	p += w * s;
	m.t = start + s;
	m.approach = first + 2.0 * second * s;
	float dish = GW_DISC_DISH * dot(p, p) / radius + GW_DISC_YIELD * radius;
	m.yields = m.t + dish / max(abs(m.approach), GW_DISC_GRAZING);
	vec3 cut = uintBitsToFloat(texelFetch(disc_tree, disc + 2).xyz);
	vec3 other = uintBitsToFloat(texelFetch(disc_tree, disc + 3).xyz);
	float over = max(dot(cut.xy, p) - cut.z, dot(other.xy, p) - other.z);
	return dot(p, p) <= radius * radius && over <= GW_DISC_CUT_SLACK * radius;
}

/* Is a disc so near to the start of the ray one of the surface that the ray leaves? */
bool is_own_disc(vec4 place, vec3 normal, DiscRay ray, float approach)
{
	float alike = dot(normal, ray.tangent_plane.xyz);
	float height = dot(ray.tangent_plane.xyz, place.xyz) - ray.tangent_plane.w;
	return approach > 0.0 || height < GW_DISC_HEIGHT * place.w * max(alike, GW_LIKE_LEAST);
}

void hit_disc(int disc, DiscRay ray, inout DiscHit hit)
{
	vec4 place = uintBitsToFloat(texelFetch(disc_tree, disc));
	uvec4 facing = texelFetch(disc_tree, disc + 1);
	vec3 normal = uintBitsToFloat(facing.xyz);
	DiscMeeting m;
	if (!meets_disc(disc, place, normal, ray, m) || m.t < 0.0 || m.t >= ray.t_max)
		return;
	if (m.t < GW_DISC_NEAR * place.w && is_own_disc(place, normal, ray, m.approach))
		return;
	if (m.approach > 0.0) {
		hit.behind = min(hit.behind, m.t);
		if (!ray.both_sides)
			return;
	}
	if (hit.lobe != GW_NONE && m.yields >= hit.yields)
		return;
	hit.t = m.t;
	hit.yields = m.yields;
	hit.lobe = facing.w;
}

/* The nearest disc that the ray meets before t_max. */
DiscHit trace_discs(vec3 origin, vec4 tangent_plane, vec3 direction, float t_max, bool both_sides)
{
	bvec3 forward = greaterThanEqual(direction, vec3(0.0));
	vec3 inverse = 1.0 / mix(direction, mix(vec3(-1e-20), vec3(1e-20), forward),
							 lessThan(abs(direction), vec3(1e-20)));
	DiscRay ray = DiscRay(origin, direction, inverse, tangent_plane, t_max, both_sides);
	DiscHit hit = DiscHit(GW_NONE, t_max, t_max, t_max);
	uint nodes = texelFetch(disc_tree, 0).x, at = 0u;
	for (uint step = 0u; step < GW_DISC_STEPS && at < nodes; step++) {
		uvec4 low = texelFetch(disc_tree, int(1u + 2u * at));
		uvec4 high = texelFetch(disc_tree, int(2u + 2u * at));
		if (!meets_box(low, high, ray, hit.yields)) {
			at = low.w;
			continue;
		}
		at++;
		if (high.w != GW_NONE)
			hit_disc(int(high.w), ray, hit);
	}
	return hit;
}

/* trace_octree, with the large discs. Where both have the surface that is hit, the octree's is the
 * finer one. */
bool trace(vec3 origin, vec4 tangent_plane, vec3 direction, float t_max, bool both_sides,
		   out uint lobe, out float t_hit, out bool behind)
{
	if (has_discs == 0u)
		return trace_octree(origin, tangent_plane, direction, t_max, both_sides, lobe, t_hit,
							behind);
	DiscHit disc = trace_discs(origin, tangent_plane, direction, t_max, both_sides);
	bool hit = trace_octree(origin, tangent_plane, direction, min(disc.yields, t_max), both_sides,
							lobe, t_hit, behind);
	if (!hit) {
		lobe = disc.lobe;
		t_hit = disc.t;
	}
	behind = behind || disc.behind < t_hit;
	return lobe != GW_NONE;
}

#endif
