/*
 * record_sky.comp - irradiance of the records from the environment's map, by directions drawn from
 * it.
 *
 * A texel is chosen by its luminance times its solid angle (alias table), a direction in it evenly;
 * so the density is luminance / total. Combined with the gather rays and the samples of openings by
 * the balance heuristic, as in opening_light.comp. One invocation takes a batch of a record's
 * samples.
 */
#version 460

#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer ray_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform usamplerBuffer leaf_tile;
layout(binding = 3) uniform samplerBuffer lobe_plane;
layout(binding = 4) uniform samplerBuffer lobe_centre;
layout(binding = 5) uniform samplerBuffer sky_texel;
layout(binding = 6) uniform usamplerBuffer sky_alias; /* alias, probability (float bits) */
layout(binding = 7) readonly buffer Position
{
	vec4 record_position[];
};
layout(binding = 8) readonly buffer Normal
{
	vec4 record_normal[];
};
layout(binding = 9) buffer Sum
{
	vec4 record_sampled[];
};
layout(binding = 10) uniform usamplerBuffer leaf_fragment;
layout(binding = 11) uniform usamplerBuffer fragment_surfel;
layout(binding = 12) uniform samplerBuffer surfel_place;
layout(binding = 13) uniform samplerBuffer surfel_facing;
layout(binding = 14) uniform samplerBuffer surfel_disc;
layout(binding = 15) uniform samplerBuffer surfel_clip;
layout(binding = 16) uniform samplerBuffer opening;
layout(binding = 17) uniform usamplerBuffer disc_tree;
layout(push_constant) uniform Push
{
	gw_record_push push;
};

#include "octree/octree_discs.glsl"
#include "octree/octree_trace.glsl"
#include "octree/disc_tree.glsl"
#include "light/openings.glsl"
#include "light/sky_map.glsl"

/* The m-th of a record's samples comes from the m-th of as many equal stretches of the table, so
 * that they spread over the sky as evenly as its light does. */
vec3 sample_sky(vec3 g, vec3 normal, float openings, uint m, uint random)
{
	uint texels = push.sky_width * push.sky_height;
	float choice = (float(m) + unit_float(random)) / float(push.sky_samples);
	uint texel = min(uint(choice * float(texels)), texels - 1u);
	uvec2 row = texelFetch(sky_alias, int(texel)).xy;
	if (unit_float(hash2(random, 3u)) >= uintBitsToFloat(row.y))
		texel = row.x;
	vec3 direction =
		sky_direction(texel, unit_float(hash2(random, 1u)), unit_float(hash2(random, 2u)));
	float cosine = dot(normal, direction);
	if (cosine <= 0.0)
		return vec3(0.0);
	uint seen;
	float t_hit;
	bool behind;
	if (trace(g, tangent_plane_at(g, normal), direction, 1e9, false, seen, t_hit, behind))
		return vec3(0.0);
	vec3 radiance = texelFetch(sky_texel, int(texel)).xyz;
	float density = luminance(radiance) / push.sky_total;
	float by_samples = float(push.sky_samples) * density;
	float by_others = push.sky_hits != 0u ? float(push.rays) * cosine / PI : 0.0;
	if (openings > 0.0)
		by_others += float(GW_OPENING_SAMPLES) * openings_density(g, normal, direction, openings);
	return radiance * (cosine / max(density, 1e-30)) * (by_samples / (by_samples + by_others));
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = record_position[i].xyz;
	vec3 normal = record_normal[i].xyz;
	uint own = hash2(hash_place(g), push.seed ^ GW_SKY_SEED);
	float openings = openings_weight(g, normal);
	vec3 sum = vec3(0.0);
	for (uint k = 0u; k < push.batch_count; k++) {
		uint m = push.batch_first + k;
		sum += sample_sky(g, normal, openings, m, hash2(own, m));
	}
	record_sampled[i].xyz += sum / float(push.sky_samples);
}
