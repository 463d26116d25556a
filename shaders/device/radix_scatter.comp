/*
 * radix_scatter.comp - puts the keys of a run where the prefix sums of the digits' counts say.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "device/sort_layout.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer low;
layout(binding = 1) uniform usamplerBuffer high;
layout(binding = 2) uniform usamplerBuffer payload;
layout(binding = 3) buffer Counts { uint counts[]; }; /* prefix sums; used up */
layout(binding = 4) writeonly buffer LowOut { uint low_out[]; };
layout(binding = 5) writeonly buffer HighOut { uint high_out[]; };
layout(binding = 6) writeonly buffer PayloadOut { uint payload_out[]; };

layout(push_constant) uniform Push { gw_radix_push push; };

void main()
{
	if (gl_GlobalInvocationID.x >= push.count)
		return;
	uint run = push.first + gl_GlobalInvocationID.x;
	uint begin = run * push.run, end = min(begin + push.run, push.total);
	for (uint i = begin; i < end; i++) {
		uint low_word = texelFetch(low, int(i)).x;
		uint high_word = push.wide != 0u ? texelFetch(high, int(i)).x : 0u;
		uint word = push.high != 0u ? high_word : low_word;
		uint digit = word >> push.shift & (GW_RADIX_DIGITS - 1u);
		uint to = counts[digit * push.runs + run]++;
		low_out[to] = low_word;
		if (push.wide != 0u)
			high_out[to] = high_word;
		payload_out[to] = push.index != 0u ? i : texelFetch(payload, int(i)).x;
	}
}
