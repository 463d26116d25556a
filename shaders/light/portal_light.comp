/*
 * portal_light.comp - sky light of the records where it comes through portals: from the gather
 * rays that left the scene, and from the samples of the portals that did. Both stand for the same
 * light, and where the sky has a map so do directions drawn from it (record_sky.comp); the balance
 * heuristic shares it out. One invocation takes a batch of a record's rays, and with the first of
 * them its samples.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"
#include "base/sampling.glsl"

TEXELS(0, uint, hit_facet);
TEXELS(1, uint, sky_seen);
TEXELS(2, vec4, portal);
TEXELS(3, vec4, sky_texel);
BUFFER(4, readonly, vec4, record_position);
BUFFER(5, readonly, vec4, record_normal);
BUFFER(6, readwrite, vec4, record_sampled);
BUFFER(7, readwrite, vec4, record_moment); /* 2 a record */
PUSH(gw_record_push);

#include "light/portals.glsl"
#include "light/record_moment.glsl"
#include "light/sky_map.glsl"

/* What all bring, and how that changes where the normal turns. */
struct Opened {
	vec3 sum, first, second;
};

/* Radiance from a direction over how densely all that may find it do. */
vec3 share_of_sky(vec3 g, vec3 normal, vec3 direction, float total)
{
	float cosine = max(0.0f, dot(normal, direction));
	float density = float(push.rays) * cosine / GW_PI +
					float(GW_PORTAL_SAMPLES) * portals_density(g, normal, direction, total);
	vec3 sum = push.sky.xyz / max(density, 1e-30f);
	if (push.sky_width != 0u) {
		vec3 radiance = texelFetch(sky_texel, sky_texel_at(direction)).xyz;
		density += float(push.sky_samples) * luminance(radiance) / push.sky_total;
		sum += radiance / max(density, 1e-30f);
	}
	return sum * cosine;
}

void add_sky(INOUT(Opened) opened, vec3 g, vec3 normal, vec3 direction, float total)
{
	vec3 irradiance = share_of_sky(g, normal, direction, total);
	opened.sum += irradiance;
	if (push.moments == 0u)
		return;
	vec2 share = moment_share_of(normal, direction);
	opened.first += irradiance * share.x;
	opened.second += irradiance * share.y;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count || record_sampled[i].w > GW_MARK_OUTSIDE)
		return;
	uint record = push.first + i;
	vec3 g = record_position[i].xyz, normal = record_normal[i].xyz;
	PortalsTurn turn = portals_begin(g, normal);
	Opened opened = { vec3(0.0f), vec3(0.0f), vec3(0.0f) };
	for (uint k = push.batch_first; k < push.batch_first + push.batch_count; k++) {
		if (texelFetch(hit_facet, int(record * push.rays + k)).x != GW_NONE)
			continue;
		float cosine;
		vec3 direction = record_ray(g, normal, k, cosine);
		add_sky(opened, g, normal, direction, turn.total);
	}
	uint seen = push.batch_first == 0u ? texelFetch(sky_seen, int(record)).x : 0u;
	for (uint m = 0u; m < GW_PORTAL_SAMPLES && seen >> m != 0u; m++) {
		vec3 direction = portals_direction(g, normal, m, turn);
		if ((seen >> m & 1u) != 0u)
			add_sky(opened, g, normal, direction, turn.total);
	}
	record_sampled[i].xyz += opened.sum;
	if (push.moments != 0u) {
		record_moment[2u * i].xyz += opened.first;
		record_moment[2u * i + 1u].xyz += opened.second;
	}
}
