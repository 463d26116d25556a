/*
 * lobe_shade.comp - shade step: radiance that each lobe reflects of one bounce's irradiance, which
 * is interpolated from the records (and, for the first reflection, of the lights' direct
 * irradiance).
 */
#version 460

#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) readonly buffer Albedo
{
	vec4 lobe_albedo[];
};
layout(binding = 1) readonly buffer Direct
{
	vec4 lobe_direct[];
};
layout(binding = 2) uniform usamplerBuffer lobe_record; /* four a texel, GW_WEIGHTS a lobe */
layout(binding = 3) uniform samplerBuffer lobe_weight;
layout(binding = 4) uniform samplerBuffer record_irradiance;
layout(binding = 5) writeonly buffer Radiance
{
	vec4 lobe_radiance[];
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
	vec3 e = push.direct_share * lobe_direct[i].xyz;
	int row = int(push.first + i) * int(GW_WEIGHTS / 4u);
	for (int t = row; t < row + int(GW_WEIGHTS / 4u); t++) {
		uvec4 record = texelFetch(lobe_record, t);
		if (record.x == GW_NONE)
			break;
		vec4 weight = texelFetch(lobe_weight, t);
		for (int k = 0; k < 4 && record[k] != GW_NONE; k++)
			e += weight[k] * texelFetch(record_irradiance, int(record[k])).xyz;
	}
	lobe_radiance[i] = vec4(lobe_albedo[i].xyz * e / 3.14159265358979, 0.0);
}
