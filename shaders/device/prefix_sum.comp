/*
 * prefix_sum.comp - adds up runs of words, or turns them into exclusive prefix sums.
 *
 * One invocation does one run, so that nothing is shared and no barrier is needed.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "device/sort_layout.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) buffer Source { uint source[]; };
layout(binding = 1) buffer Sums { uint sums[]; };

layout(push_constant) uniform Push { gw_prefix_push push; };

void main()
{
	if (gl_GlobalInvocationID.x >= push.count)
		return;
	uint run = push.first + gl_GlobalInvocationID.x;
	uint begin = run * GW_PREFIX_RUN, end = min(begin + GW_PREFIX_RUN, push.total);
	uint sum = 0u;
	if (push.scan == 0u) {
		for (uint i = begin; i < end; i++)
			sum += source[push.source + i];
		sums[push.sums + run] = sum;
		return;
	}
	if (push.offsets != 0u)
		sum = sums[push.sums + run];
	for (uint i = begin; i < end; i++) {
		uint value = source[push.source + i];
		source[push.source + i] = sum;
		sum += value;
	}
}
