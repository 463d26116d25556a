/*
 * light_irradiance.comp - adds one light's irradiance at each surfel: analytic, times the
 * visibility that light_visibility.comp or shadow_map_visibility.comp found.
 */
#version 460

#include "transport_layout.h"

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

#include "light.glsl"

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
	if (push.shadows != 0u)
		e *= visibility[i];
	irradiance[i].xyz += push.power.xyz * e;
}
