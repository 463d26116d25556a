/*
 * light_visibility.comp - which share of a light each surfel sees, by shadow rays.
 *
 * One invocation a surfel. A light without extent gets one ray; one with a radius gets
 * push.samples rays to points spread over the disc that it shows: first to its rim, and to the rest
 * of it only where some of these see it and some do not. What hides the light is told as
 * GW_HIDDEN_BY_CREASE says. Surface that lets light through dims it.
 */
#include "octree/octree_layout.h"
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
BUFFER(5, readonly, vec4, surfel_position);
BUFFER(6, readonly, vec4, surfel_normal);
BUFFER(7, readwrite, float, visibility);
TEXELS(8, uint, leaf_fragment);
TEXELS(9, uint, fragment_surfel);
TEXELS(10, vec4, surfel_place);
TEXELS(11, vec4, surfel_facing);
TEXELS(12, vec4, surfel_disc);
TEXELS(13, vec4, surfel_clip);
TEXELS(14, uvec4, disc_tree);
BUFFER(15, readonly, float, distribution);
TEXELS(16, vec4, facet_albedo);
BUFFER(17, readonly, uint, facet_leaf);
PUSH(gw_light_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/light.glsl"

/* Do most of the discs in the facet's leaf that end there do so at a crease? */
bool ends_at_crease(uint facet)
{
	uint leaf = leaf_of(owner_of(facet).word), last = texelFetch(leaf_fragment, int(leaf) + 1).x;
	int votes = 0;
	for (uint f = texelFetch(leaf_fragment, int(leaf)).x; f < last; f++) {
		int surfel = int(texelFetch(fragment_surfel, int(f)).x & GW_FRAGMENT_SURFEL);
		vec4 size = texelFetch(surfel_disc, surfel);
		if (size.z != 0.0f || size.w != 0.0f)
			votes += texelFetch(surfel_facing, surfel).w < -0.5f ? 1 : -1;
	}
	return votes > 0;
}

/* A ray to the light's sample `s`, and what the sample counts: those of a light that is an area by
 * the cosine at which they come in. */
float aim(uint s, vec4 normal, vec3 towards, float distance, float turn, INOUT(Ray) ray)
{
	if (!is_area_light()) {
		aim_at_light(push.samples - 1u - s, turn, towards, distance, ray);
		return 1.0f;
	}
	float weight;
	aim_at_area(s, turn, ray.origin, ray, weight);
	return weight * light_cosine(normal, ray.direction);
}

/* A shadow's edge is as much further off than what casts it as it is further from the light. */
float edge_further(float distance, float hit)
{
	if (push.type == GW_PUSH_SUN)
		return 1.0f;
	return distance / max(distance - hit, distance / GW_FURTHER_MOST);
}

/* Share of the light that is seen from where the ray begins, or why none is. */
float share_seen(vec4 normal, vec3 towards, float distance, float turn, INOUT(Ray) ray)
{
	vec3 facing = ray.facing;
	float seen = 0.0f, whole = 0.0f, hidden = 0.0f;
	for (uint s = 0u; s < push.samples; s++) {
		float weight = aim(s, normal, towards, distance, turn, ray), through;
		if (!(weight > 0.0f))
			continue;
		vec3 to = is_area_light() ? ray.direction : towards;
		ray.facing = dot(normal.xyz, to) < 0.0f ? -facing : facing;
		Hit hit = trace_through(ray, GW_THROUGH_LEAST, through);
		whole += weight;
		if (hit.facet == GW_NONE)
			seen += weight * through;
		else if (ends_at_crease(hit.facet))
			hidden = GW_HIDDEN_BY_CREASE;
		else if (push.samples == 1u)
			return -edge_further(distance, hit.t);
		if (s + 1u == GW_LIGHT_RIM && !is_area_light() &&
			(seen == 0.0f || seen == float(GW_LIGHT_RIM)))
			break;
	}
	return whole > 0.0f ? seen / whole + hidden : 0.0f;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = surfel_position[i].xyz, towards;
	vec4 normal = surfel_normal[i];
	float distance;
	visibility[i] = 0.0f;
	if (!(light_received(g, normal, towards, distance) > 0.0f))
		return;
	/* The ray leaves the surface behind the noise; the normal is the point's own. */
	vec3 facing = texelFetch(surfel_facing, int(push.first + i)).xyz;
	float turn = unit_float(pcg_hash2(push.first + i, push.seed));
	Ray ray = { g, towards, facing, g, distance, true };
	visibility[i] = share_seen(normal, towards, distance, turn, ray);
}
