/*
 * test_affine.comp - for the unit test of the device layer: out[i] = in[i] * factor + i.
 *
 * Both buffers are windowed: they are indexed from 0 in every slice.
 */
#version 450

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint factor = 1;

layout(binding = 0) readonly buffer Input { uint value[]; };
layout(binding = 1) writeonly buffer Output { uint result[]; };

layout(push_constant) uniform Push {
	uint first, count; /* gw_span */
	uint offset;
};

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= count)
		return;
	result[i] = value[i] * factor + first + i + offset;
}
