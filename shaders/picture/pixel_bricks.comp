/*
 * pixel_bricks.comp - radiance read from the bricks of the leaves at a pixel's position (Salm 4.6):
 * trilinear, or tricubic by a B-spline of eight trilinear samples (Sigg and Hadwiger 2005). What is
 * read is radiance times area and area, seen against the pixel's normal; their ratio is the
 * radiance. w is that area: 0 where the bricks hold nothing that faces the pixel.
 */
#version 460

#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer level_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform sampler3D leaf_pool;
layout(binding = 3) uniform sampler3D mip_pool;
layout(binding = 4) readonly buffer Position
{
	vec4 pixel_position[]; /* grid coordinates */
};
layout(binding = 5) readonly buffer Normal
{
	vec4 pixel_normal[]; /* unit */
};
layout(binding = 6) writeonly buffer Radiance
{
	vec4 pixel_radiance[];
};
layout(push_constant) uniform Push
{
	gw_cone_push push;
};

#include "light/brick_cones.glsl"

/* Levels above the leaves that are asked where the leaves have nothing. */
const uint COARSER = 2u;

vec4 sample_cubic(vec3 g, vec3 direction, uint up)
{
	float size = exp2(float(up));
	vec3 p = g / size - 0.5, whole = floor(p), f = p - whole, r = 1.0 - f;
	vec3 w0 = r * r * r / 6.0, w3 = f * f * f / 6.0;
	vec3 w1 = (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0, w2 = 1.0 - w0 - w1 - w3;
	vec3 low = whole - 1.0 + w1 / (w0 + w1), high = whole + 1.0 + w3 / (w2 + w3);
	vec4 sum = vec4(0.0);
	for (int c = 0; c < 8; c++) {
		bvec3 upper = bvec3((c & 1) != 0, (c & 2) != 0, (c & 4) != 0);
		vec3 weight = mix(w0 + w1, w2 + w3, upper);
		vec3 at = (mix(low, high, upper) + 0.5) * size;
		sum += weight.x * weight.y * weight.z * sample_level(at, direction, up);
	}
	return sum;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = pixel_position[i].xyz;
	vec3 normal = pixel_normal[i].xyz;
	if (dot(normal, push.eye.xyz - g) < 0.0)
		normal = -normal;
	vec4 shown = vec4(0.0);
	for (uint up = 0u; up <= min(COARSER, depth - 1u) && shown.w < 1e-3; up++)
		shown = push.eye.w > 0.5 ? sample_cubic(g, -normal, up) : sample_level(g, -normal, up);
	vec3 radiance = shown.w > 0.0 ? shown.xyz / (shown.w * push.scale) : vec3(0.0);
	pixel_radiance[i] = vec4(radiance, shown.w);
}
