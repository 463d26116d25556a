/*
 * record_gather.comp - one bounce at the records: mean radiance of what their rays hit, a sparse
 * product over the stored hits. E = pi/K sum L(hit). Adds it to the indirect irradiance.
 */
#version 460

#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer hit_lobe;
layout(binding = 1) uniform samplerBuffer lobe_radiance;
layout(binding = 2) readonly buffer Normal
{
	vec4 record_normal[];
}; /* w: 0 if buried */
layout(binding = 3) writeonly buffer Gathered
{
	vec4 record_gathered[];
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
	uint first = (push.first + i) * push.rays;
	vec3 sum = vec3(0.0);
	for (uint k = 0u; k < push.rays; k++) {
		uint lobe = texelFetch(hit_lobe, int(first + k)).x;
		if (lobe != GW_NONE)
			sum += texelFetch(lobe_radiance, int(lobe)).xyz;
	}
	record_gathered[i] =
		vec4(sum * record_normal[i].w * (3.14159265358979 / float(push.rays)), 0.0);
}
