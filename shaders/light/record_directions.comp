/*
 * record_directions.comp - the directions of some of the records' rays, by the rays' numbers.
 */
#version 460

#include "light/transport_layout.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer listed;
layout(binding = 1) uniform samplerBuffer record_position;
layout(binding = 2) uniform samplerBuffer record_normal;
layout(binding = 3) writeonly buffer Direction
{
	vec4 ray_direction[];
};
layout(push_constant) uniform Push
{
	gw_record_push push;
};

#include "light/record_ray.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint ray = texelFetch(listed, int(push.first + i)).x;
	int record = int(ray / push.rays);
	float cosine;
	ray_direction[i] = vec4(record_ray(texelFetch(record_position, record).xyz,
									   texelFetch(record_normal, record).xyz, ray % push.rays,
									   cosine),
							0.0);
}
