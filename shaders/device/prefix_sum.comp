/*
 * prefix_sum.comp - adds up runs of words, or turns them into exclusive prefix sums.
 *
 * One invocation does one run, so that nothing is shared and no barrier is needed.
 */
#include "base/pass.glsl"
#include "device/sort_layout.h"

BUFFER(0, readwrite, uint, words);
BUFFER(1, readwrite, uint, sums);
PUSH(gw_prefix_push);

void main()
{
	if (gl_GlobalInvocationID.x >= push.count)
		return;
	uint run = push.first + gl_GlobalInvocationID.x;
	uint begin = push.source + run * GW_PREFIX_RUN;
	uint end = begin + min(GW_PREFIX_RUN, push.total - run * GW_PREFIX_RUN);
	uint sum = 0u;
	if (push.scan == 0u) {
		for (uint i = begin; i < end; i++)
			sum += words[i];
		sums[push.sums + run] = sum;
		return;
	}
	if (push.offsets != 0u)
		sum = sums[push.sums + run];
	for (uint i = begin; i < end; i++) {
		uint value = words[i];
		words[i] = sum;
		sum += value;
	}
}
