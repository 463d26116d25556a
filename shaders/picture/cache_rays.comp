/*
 * cache_rays.comp - trace step of gloss caches: one ray an invocation, from a cache through a place
 * within one texel of its hemisphere; what it meets goes into the texel. One run adds one ray,
 * because all loops of an invocation count together towards what the software driver allows.
 */
#include "picture/gloss_cache.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, uint, leaf_fragment);
TEXELS(6, uint, fragment_surfel);
TEXELS(7, vec4, surfel_place);
TEXELS(8, vec4, surfel_facing);
TEXELS(9, vec4, surfel_disc);
TEXELS(10, vec4, surfel_clip);
TEXELS(11, vec4, surfel_radiance);
TEXELS(12, vec4, cache_place);  /* grid coordinates */
TEXELS(13, vec4, cache_facing); /* unit, roughness */
BUFFER(14, readwrite, vec4, cache_texel);
TEXELS(15, uvec4, disc_tree);
TEXELS(16, vec4, sky_texel);
TEXELS(17, vec4, facet_albedo);
BUFFER(18, readonly, uint, facet_leaf);
PUSH(gw_cache_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "picture/disc_light.glsl"
#include "picture/hemisphere_map.glsl"
#include "picture/sky_seen.glsl"

/* Of a place in the map, whose texels are of width 1. */
vec3 direction_of(vec2 place, vec3 t, vec3 b, vec3 normal)
{
	vec3 way = hemisphere_direction(place / float(GW_CACHE_SIDE));
	return normalize(t * way.x + b * way.y + normal * way.z);
}

/* Rays of a texel: several where the pixel that the cache stands at looks, by facets that turn less
 * than most. */
uint rays_of(vec3 g, vec4 facing, vec3 way)
{
	float alpha = facing.w * facing.w;
	float cosine = dot(facing.xyz, normalize(normalize(push.eye.xyz - g) + way));
	float square = cosine * cosine, most = GW_CACHE_TURN * GW_CACHE_TURN * alpha * alpha;
	return 1.0f - square < most * square ? GW_CACHE_RAYS : 1u;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = push.first + i, texels = GW_CACHE_SIDE * GW_CACHE_SIDE;
	uint cache = number / texels, k = number % texels;
	vec3 g = texelFetch(cache_place, int(cache)).xyz;
	vec4 facing = texelFetch(cache_facing, int(cache));
	vec3 normal = facing.xyz, t, b;
	tangent_frame(normal, t, b);
	vec2 corner = vec2(float(k % GW_CACHE_SIDE), float(k / GW_CACHE_SIDE));
	uint rays = rays_of(g, facing, direction_of(corner + vec2(0.5f), t, b, normal));
	if (push.ray >= rays)
		return;
	uint own = pcg_hash2(pcg_hash_place(g), push.seed), ray_number = GW_CACHE_RAYS * k + push.ray;
	uint shift = pcg_hash2(own, ray_number);
	vec2 within = vec2(unit_float(shift), unit_float(pcg_hash(shift)));
	if (rays > 1u)
		within = (within + vec2(float(push.ray & 1u), float(push.ray >> 1))) * 0.5f;
	vec3 direction = direction_of(corner + within, t, b, normal);
	Ray ray = { g, direction, normal, g, GW_FAR, false };
	float through, chance = stratified(pcg_hash2(own, GW_OPACITY_SEED), ray_number);
	Hit hit = trace_through(ray, chance, through);
	bool met = hit.facet != GW_NONE;
	vec3 seen = met ? radiance_at(hit.facet, g + direction * hit.t) : sky_seen(direction);
	vec4 found = vec4(seen, met ? 1.0f / max(hit.t, 1e-3f) : 0.0f) * (1.0f / float(rays));
	uint to = cache * GW_CACHE_TEXELS + k;
	cache_texel[to] = push.ray > 0u ? cache_texel[to] + found : found;
}
