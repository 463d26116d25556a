/*
 * record_add.comp - adds what one bounce brought to what the records have, push.share times.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"

BUFFER(0, readonly, vec4, record_gathered);
BUFFER(1, readwrite, vec4, record_sum);
PUSH(gw_record_push);

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec4 more = record_gathered[i];
	record_sum[i] += vec4(more.xyz * push.share, more.w * push.share);
}
