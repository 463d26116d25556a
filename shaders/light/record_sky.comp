/*
 * record_sky.comp - irradiance of the records from the environment's map, by directions drawn from
 * it.
 *
 * A texel is chosen by its luminance times its solid angle (alias table), a direction in it evenly;
 * so the density is luminance / total. Combined with the gather rays and the samples of portals by
 * the balance heuristic, as in portal_light.comp. One invocation takes a batch of a record's
 * samples.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, vec4, sky_texel);
TEXELS(6, uvec2, sky_alias); /* alias, probability (float bits) */
BUFFER(7, readonly, vec4, record_position);
BUFFER(8, readonly, vec4, record_normal);
BUFFER(9, readwrite, vec4, record_sampled);
TEXELS(10, uint, leaf_fragment);
TEXELS(11, uint, fragment_surfel);
TEXELS(12, vec4, surfel_place);
TEXELS(13, vec4, surfel_facing);
TEXELS(14, vec4, surfel_disc);
TEXELS(15, vec4, surfel_clip);
TEXELS(16, vec4, portal);
TEXELS(17, uvec4, disc_tree);
TEXELS(18, vec4, facet_albedo);
BUFFER(19, readwrite, vec4, record_moment); /* 2 a record */
BUFFER(20, readonly, uint, facet_leaf);
PUSH(gw_record_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/portals.glsl"
#include "light/sky_map.glsl"
#include "light/record_moment.glsl"

/* The m-th of a record's samples comes from the m-th of as many equal stretches of the table, so
 * that they spread over the sky as evenly as its light does. Also from where it comes. */
vec3 sample_sky(vec3 g, vec3 normal, float portals, uint m, uint random, OUT(vec3) direction)
{
	uint texels = push.sky_width * push.sky_height;
	float choice = (float(m) + unit_float(random)) / float(push.sky_samples);
	uint texel = min(uint(choice * float(texels)), texels - 1u);
	uvec2 row = texelFetch(sky_alias, int(texel)).xy;
	if (unit_float(pcg_hash2(random, 3u)) >= uintBitsToFloat(row.y))
		texel = row.x;
	direction =
		sky_direction(texel, unit_float(pcg_hash2(random, 1u)), unit_float(pcg_hash2(random, 2u)));
	float cosine = dot(normal, direction);
	if (cosine <= 0.0f)
		return vec3(0.0f);
	Ray ray = { g, direction, normal, g, GW_FAR, false };
	float through;
	if (trace_through(ray, GW_THROUGH_LEAST, through).facet != GW_NONE)
		return vec3(0.0f);
	vec3 radiance = texelFetch(sky_texel, int(texel)).xyz;
	float density = luminance(radiance) / push.sky_total;
	float by_samples = float(push.sky_samples) * density;
	float by_others = push.sky_hits != 0u ? float(push.rays) * cosine / GW_PI : 0.0f;
	if (portals > 0.0f)
		by_others += float(GW_PORTAL_SAMPLES) * portals_density(g, normal, direction, portals);
	return radiance * (through * cosine / max(density, 1e-30f) *
					   (by_samples / (by_samples + by_others)));
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count || record_sampled[i].w > GW_MARK_OUTSIDE)
		return;
	vec3 g = record_position[i].xyz;
	vec3 normal = record_normal[i].xyz;
	uint own = pcg_hash2(pcg_hash_place(g), push.seed ^ GW_SKY_SEED);
	float portals = portals_weight(g, normal);
	vec3 sum = vec3(0.0f), first = vec3(0.0f), second = vec3(0.0f);
	for (uint m = push.batch_first; m < push.batch_first + push.batch_count; m++) {
		vec3 direction;
		vec3 irradiance = sample_sky(g, normal, portals, m, pcg_hash2(own, m), direction);
		sum += irradiance;
		if (push.moments == 0u)
			continue;
		vec2 share = moment_share_of(normal, direction);
		first += irradiance * share.x;
		second += irradiance * share.y;
	}
	record_sampled[i].xyz += sum / float(push.sky_samples);
	if (push.moments != 0u) {
		record_moment[2u * i].xyz += first / float(push.sky_samples);
		record_moment[2u * i + 1u].xyz += second / float(push.sky_samples);
	}
}
