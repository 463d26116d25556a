/*
 * light_irradiance.comp - adds one light's irradiance at each surfel: analytic, times the
 * visibility that light_visibility.comp or shadow_map_visibility.comp found. The fourth component
 * is luminance that was hidden: above 0 by surface of which nobody knows exactly where it ends,
 * below 0 by what ends at a crease; not there where the lamp has an extent, whose penumbra is far
 * wider than what is unknown of a crease.
 */
#version 460

#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) readonly buffer Position
{
	vec4 surfel_position[];
};
layout(binding = 1) readonly buffer Normal
{
	vec4 surfel_normal[];
};
layout(binding = 2) readonly buffer Visibility
{
	float visibility[];
};
layout(binding = 3) buffer Irradiance
{
	vec4 irradiance[];
};
layout(push_constant) uniform Push
{
	gw_light_push push;
};

#include "light/light.glsl"
#include "base/sampling.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = surfel_position[i].xyz;
	float distance;
	vec3 towards;
	float facing = light_irradiance(g, towards, distance);
	float e = light_cosine(g, surfel_normal[i], facing, towards);
	float seen = push.shadows != 0u ? visibility[i] : 1.0, sign = 1.0;
	if (seen >= GW_HIDDEN_BY_CREASE) {
		seen -= GW_HIDDEN_BY_CREASE;
		sign = push.samples > 1u ? 0.0 : -1.0;
	}
	float hidden = sign * (1.0 - seen);
	irradiance[i] += e * vec4(push.power.xyz * seen, luminance(push.power.xyz) * hidden);
}
