/*
 * record_first.comp - irradiance that reaches a record unreflected: from the emitters its rays hit
 * (weighted against record_emitters.comp by the balance heuristic), from the samples of emitters,
 * and from the sky where rays left the scene (its map weighted against record_sky.comp). Unless
 * that is known, also the distance to the nearest thing it saw, and whether it is buried.
 */
#version 460

#include "light/transport_layout.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer hit_lobe;
layout(binding = 1) uniform samplerBuffer hit_distance;
layout(binding = 2) uniform samplerBuffer lobe_plane;
layout(binding = 3) uniform samplerBuffer lobe_emission;
layout(binding = 4) readonly buffer Sampled
{
	vec4 record_sampled[];
};
layout(binding = 5) buffer Position
{
	vec4 record_position[];
};
layout(binding = 6) buffer Normal
{
	vec4 record_normal[];
};
layout(binding = 7) writeonly buffer First
{
	vec4 record_first[];
};
layout(binding = 8) uniform samplerBuffer lobe_part; /* of lobe_emission: what is gathered */
layout(binding = 9) uniform samplerBuffer sky_texel;
layout(push_constant) uniform Push
{
	gw_record_push push;
};

#include "light/record_ray.glsl"
#include "light/sky_map.glsl"

/* Share of an emitter's light that the hit of gather ray k stands for. */
float hit_weight(vec3 g, vec3 normal, uint k, uint lobe, float t, vec3 emission)
{
	float cosine;
	vec3 direction = record_ray(g, normal, k, cosine);
	float cosine_emitter = max(1e-4, -dot(texelFetch(lobe_plane, int(lobe)).xyz, direction));
	float density = luminance(emission) / push.emitter_power * t * t / cosine_emitter;
	float by_rays = float(push.rays) * cosine / PI;
	return by_rays / (by_rays + float(push.light_samples) * density);
}

/* What the map sends along a gather ray that left the scene, as far as that ray stands for it. */
vec3 seen_sky(vec3 g, vec3 normal, uint k)
{
	float cosine;
	vec3 direction = record_ray(g, normal, k, cosine);
	vec3 radiance = texelFetch(sky_texel, sky_texel_at(direction)).xyz;
	float by_samples = float(push.sky_samples) * luminance(radiance) / push.sky_total;
	float by_rays = float(push.rays) * cosine / PI;
	return radiance * (by_rays / max(by_rays + by_samples, 1e-30));
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint record = push.first + i;
	vec3 sum = vec3(0.0);
	float nearest = 1e9;
	uint behind = 0u;
	bool look = push.looked == 0u;
	for (uint k = 0u; k < push.rays; k++) {
		int h = int(record * push.rays + k);
		uint lobe = texelFetch(hit_lobe, h).x;
		if (look) {
			float t = texelFetch(hit_distance, h).x;
			behind += t < 0.0 ? 1u : 0u;
			nearest = min(nearest, abs(t));
		}
		if (lobe == GW_NONE) {
			sum += push.sky.xyz;
			if (push.sky_hits != 0u)
				sum += seen_sky(record_position[i].xyz, record_normal[i].xyz, k);
			continue;
		}
		if (push.use_hits == 0u)
			continue;
		vec3 emission = texelFetch(lobe_emission, int(lobe)).xyz;
		if (luminance(emission) <= 0.0)
			continue;
		float weight = 1.0;
		if (push.light_samples > 0u)
			weight = hit_weight(record_position[i].xyz, record_normal[i].xyz, k, lobe,
								abs(texelFetch(hit_distance, h).x), emission);
		sum += texelFetch(lobe_part, int(lobe)).xyz * weight;
	}
	if (look) {
		/* A record that sees mostly the backs of surfaces lies inside something solid. */
		record_position[i].w = nearest;
		record_normal[i].w = 2u * behind > push.rays ? 0.0 : 1.0;
	}
	bool buried = record_normal[i].w == 0.0;
	vec3 first = sum * PI / float(push.rays) + record_sampled[i].xyz;
	record_first[i] = vec4(buried ? vec3(0.0) : first, 0.0);
}
