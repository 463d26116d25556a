/*
 * radix_count.comp - how often each digit occurs in a run of keys.
 *
 * One invocation does one run. The counts lie digit by digit, and run by run for each, so that
 * their prefix sums are the places where a stable sort puts each run's keys.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "device/sort_layout.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer keys;      /* the word that has the digit */
layout(binding = 1) buffer Counts { uint counts[]; };

layout(push_constant) uniform Push { gw_radix_push push; };

void main()
{
	if (gl_GlobalInvocationID.x >= push.count)
		return;
	uint run = push.first + gl_GlobalInvocationID.x;
	uint begin = run * push.run, end = min(begin + push.run, push.total);
	for (uint digit = 0; digit < GW_RADIX_DIGITS; digit++)
		counts[digit * push.runs + run] = 0;
	for (uint i = begin; i < end; i++) {
		uint digit = texelFetch(keys, int(i)).x >> push.shift & (GW_RADIX_DIGITS - 1u);
		counts[digit * push.runs + run]++;
	}
}
