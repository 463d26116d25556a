/*
 * cache_rays.comp - trace step of gloss caches: one ray an invocation, from a cache through a place
 * within one texel of its hemisphere; what it meets goes into the texel.
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
TEXELS(13, vec4, cache_facing); /* unit */
BUFFER(14, writeonly, vec4, cache_texel);
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

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = push.first + i, texels = GW_CACHE_SIDE * GW_CACHE_SIDE;
	uint cache = number / texels, k = number % texels;
	vec3 g = texelFetch(cache_place, int(cache)).xyz;
	vec3 normal = texelFetch(cache_facing, int(cache)).xyz, t, b;
	tangent_frame(normal, t, b);
	uint own = pcg_hash2(pcg_hash_place(g), push.seed), shift = pcg_hash2(own, k);
	vec2 within = vec2(unit_float(shift), unit_float(pcg_hash(shift)));
	vec2 corner = vec2(float(k % GW_CACHE_SIDE), float(k / GW_CACHE_SIDE));
	vec3 way = hemisphere_direction((corner + within) / float(GW_CACHE_SIDE));
	vec3 direction = normalize(t * way.x + b * way.y + normal * way.z);
	Ray ray = { g, direction, normal, g, GW_FAR, false };
	float through, chance = stratified(pcg_hash2(own, GW_OPACITY_SEED), k);
	Hit hit = trace_through(ray, chance, through);
	bool met = hit.facet != GW_NONE;
	vec3 seen = met ? radiance_at(hit.facet, g + direction * hit.t) : sky_seen(direction);
	cache_texel[cache * GW_CACHE_TEXELS + k] = vec4(seen, met ? 1.0f / max(hit.t, 1e-3f) : 0.0f);
}
