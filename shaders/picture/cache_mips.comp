/*
 * cache_mips.comp - the coarser levels of gloss caches, one cache an invocation. Texels of a level
 * are of one solid angle, so that each is the mean of the four that it is made of.
 */
#include "picture/gloss_cache.h"
#include "base/pass.glsl"

BUFFER(0, readwrite, vec4, cache_texel);
PUSH(gw_cache_push);

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint base = (push.first + i) * GW_CACHE_TEXELS;
	for (uint level = 1u; level < GW_CACHE_LEVELS; level++) {
		uint side = GW_CACHE_SIDE >> level, finer = 2u * side;
		uint from = base + cache_level_first(level - 1u), to = base + cache_level_first(level);
		for (uint k = 0u; k < side * side; k++) {
			uint corner = from + 2u * (k / side) * finer + 2u * (k % side);
			cache_texel[to + k] = (cache_texel[corner] + cache_texel[corner + 1u] +
								   cache_texel[corner + finer] + cache_texel[corner + finer + 1u]) *
								  0.25f;
		}
	}
}
