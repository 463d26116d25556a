/*
 * record_add.comp - adds what one bounce brought to what the records have.
 */
#version 460

#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) readonly buffer Gathered
{
	vec4 record_gathered[];
};
layout(binding = 1) buffer Sum
{
	vec4 record_sum[];
};
layout(push_constant) uniform Push
{
	gw_record_push push;
};

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	record_sum[i] += record_gathered[i];
}
