/*
 * record_first.comp - irradiance that reaches a record unreflected: from the emitters its rays hit
 * (weighted against record_emitters.comp by the balance heuristic), from the samples of emitters,
 * and from the sky where rays left the scene (its map weighted against record_sky.comp). Unless
 * that is known, also the distance to the nearest thing it saw, and whether it is buried. To one
 * that is, backs are black: only what its rays meet before any back counts, and of samples their
 * share.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"

TEXELS(0, uint, hit_facet);
TEXELS(1, float, hit_distance);
TEXELS(2, vec4, facet_plane);
TEXELS(3, vec4, facet_emission);
BUFFER(4, readonly, vec4, record_sampled);
BUFFER(5, readwrite, vec4, record_position);
BUFFER(6, readwrite, vec4, record_normal);
BUFFER(7, writeonly, vec4, record_first);
TEXELS(8, vec4, facet_part); /* of facet_emission: what is gathered */
TEXELS(9, vec4, sky_texel);
BUFFER(10, readwrite, vec4, record_moment); /* 2 a record: of samples, then of all */
PUSH(gw_record_push);

#include "light/record_moment.glsl"
#include "light/sky_map.glsl"

/* Share of an emitter's light that the hit of gather ray k stands for. */
float hit_share(vec3 g, vec3 normal, uint k, int facet, float t)
{
	float ray_cosine;
	vec3 direction = record_ray(g, normal, k, ray_cosine);
	float cosine = max(0.0f, dot(normal, direction));
	float cosine_emitter = max(1e-4f, -dot(texelFetch(facet_plane, facet).xyz, direction));
	float emission = luminance(texelFetch(facet_emission, facet).xyz);
	float density = emission / push.emitter_power * t * t / cosine_emitter;
	float by_rays = float(push.rays) * cosine / GW_PI;
	return by_rays / (by_rays + float(push.light_samples) * density);
}

/* What the map sends along a gather ray that left the scene, as far as that ray stands for it. */
vec3 seen_sky(vec3 g, vec3 normal, uint k)
{
	float cosine;
	vec3 direction = record_ray(g, normal, k, cosine);
	vec3 radiance = texelFetch(sky_texel, sky_texel_at(direction)).xyz;
	float by_samples = float(push.sky_samples) * luminance(radiance) / push.sky_total;
	float by_rays = float(push.rays) * cosine / GW_PI;
	return radiance * (by_rays / max(by_rays + by_samples, 1e-30f));
}

/* What ray k brings, whose hit is the h-th of all; where the sky is shut out, what left the scene
 * has slipped through. */
vec3 light_of_ray(vec3 g, vec3 normal, bool shut, uint k, int h)
{
	uint facet = texelFetch(hit_facet, h).x;
	if (facet == GW_NONE && shut)
		return vec3(0.0f);
	if (facet == GW_NONE)
		return push.sky_hits != 0u ? push.sky.xyz + seen_sky(g, normal, k) : push.sky.xyz;
	if (push.use_hits == 0u || !(luminance(texelFetch(facet_emission, int(facet)).xyz) > 0.0f))
		return vec3(0.0f);
	float share = 1.0f;
	if (push.light_samples > 0u)
		share = hit_share(g, normal, k, int(facet), abs(texelFetch(hit_distance, h).x));
	return texelFetch(facet_part, int(facet)).xyz * share;
}

/* The nearest thing that a record sees, and 1; or, of one that sees mostly the backs of surfaces
 * and so may lie inside something solid, the share of its rays that pass none. */
void look_around(uint i, int first)
{
	float nearest = GW_FAR;
	uint behind = 0u;
	for (uint k = 0u; k < push.rays; k++) {
		float t = texelFetch(hit_distance, first + int(k)).x;
		behind += t < 0.0f ? 1u : 0u;
		nearest = min(nearest, abs(t));
	}
	record_position[i].w = nearest;
	float before = float(push.rays - behind) / float(push.rays);
	record_normal[i].w = 2u * behind > push.rays ? before : 1.0f;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	int first = int((push.first + i) * push.rays);
	vec3 g = record_position[i].xyz, normal = record_normal[i].xyz, sum = vec3(0.0f);
	bool shut = record_sampled[i].w > GW_MARK_OUTSIDE;
	if (push.looked == 0u)
		look_around(i, first);
	float before = record_normal[i].w;
	vec3 along = vec3(0.0f), across = vec3(0.0f);
	for (uint k = 0u; k < push.rays; k++) {
		if (before < 1.0f && texelFetch(hit_distance, first + int(k)).x < 0.0f)
			continue;
		vec3 radiance = light_of_ray(g, normal, shut, k, first + int(k));
		sum += radiance;
		if (push.moments == 0u)
			continue;
		vec2 share = moment_share_of_ray(g, k);
		along += radiance * share.x;
		across += radiance * share.y;
	}
	float each = GW_PI / float(push.rays);
	record_first[i] = vec4(sum * each + record_sampled[i].xyz * before, 0.0f);
	if (push.moments != 0u) {
		record_moment[2u * i].xyz = along * each + record_moment[2u * i].xyz * before;
		record_moment[2u * i + 1u].xyz = across * each + record_moment[2u * i + 1u].xyz * before;
	}
}
