/*
 * octree_keys.glsl - reading a sorted list of keys, whose high words may lie apart.
 */
#include "octree/octree_common.glsl"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer keys;      /* one word, or two */
layout(binding = 1) uniform usamplerBuffer keys_high; /* only of a list that is split */

layout(push_constant) uniform Push { gw_keys_push push; };

uvec2 read_key(uint i)
{
	uvec2 key = texelFetch(keys, int(i)).xy;
	if (push.split != 0u)
		key.y = texelFetch(keys_high, int(i)).x;
	return push.shift != 0u ? key_parent(key) : key;
}

bool begins(uint i)
{
	return i == 0u || read_key(i) != read_key(i - 1u);
}
