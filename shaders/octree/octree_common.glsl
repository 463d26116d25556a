/*
 * octree_common.glsl - Morton keys of up to 48 bits as two words, and searching lists of them.
 */
#ifndef OCTREE_COMMON_GLSL
#define OCTREE_COMMON_GLSL

#include "octree/octree_layout.h"

/* Bit i of ten bits goes to bit 3 i. */
uint spread_bits(uint v)
{
	v &= 0x3ffu;
	v = (v | v << 16) & 0x030000ffu;
	v = (v | v << 8) & 0x0300f00fu;
	v = (v | v << 4) & 0x030c30c3u;
	return (v | v << 2) & 0x09249249u;
}

uint gather_bits(uint v)
{
	v &= 0x09249249u;
	v = (v | v >> 2) & 0x030c30c3u;
	v = (v | v >> 4) & 0x0300f00fu;
	v = (v | v >> 8) & 0x030000ffu;
	return (v | v >> 16) & 0x3ffu;
}

uint interleave(uvec3 v)
{
	return spread_bits(v.x) | spread_bits(v.y) << 1 | spread_bits(v.z) << 2;
}

/* x: bits 0-31, y: bits 32-63. */
uvec2 morton_encode(uvec3 cell)
{
	uint low = interleave(cell & 0x3ffu), high = interleave(cell >> 10);
	return uvec2(low | high << 30, high >> 2);
}

uvec3 morton_decode(uvec2 key)
{
	uint low = key.x & 0x3fffffffu, high = key.x >> 30 | key.y << 2;
	uvec3 l = uvec3(gather_bits(low), gather_bits(low >> 1), gather_bits(low >> 2));
	uvec3 h = uvec3(gather_bits(high), gather_bits(high >> 1), gather_bits(high >> 2));
	return l | h << 10;
}

uvec2 key_parent(uvec2 key)
{
	return uvec2(key.x >> 3 | key.y << 29, key.y >> 3);
}

uvec2 key_first_child(uvec2 key)
{
	return uvec2(key.x << 3, key.y << 3 | key.x >> 29);
}

bool key_less(uvec2 a, uvec2 b)
{
	return a.y < b.y || (a.y == b.y && a.x < b.x);
}

/* Index of the first key in a sorted list that is not less; count when all are. */
uint lower_bound(usamplerBuffer keys, uint count, uvec2 key)
{
	uint first = 0u;
	while (count > 0u) {
		uint step = count >> 1;
		if (key_less(texelFetch(keys, int(first + step)).xy, key)) {
			first += step + 1u;
			count -= step + 1u;
		} else {
			count = step;
		}
	}
	return first;
}

/* Index plus one of a key in a sorted list; 0 when it isn't there. */
uint find_key(usamplerBuffer keys, uint count, uvec2 key)
{
	uint at = lower_bound(keys, count, key);
	return at < count && texelFetch(keys, int(at)).xy == key ? at + 1u : 0u;
}

#endif
