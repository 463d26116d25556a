/*
 * test_affine.comp - for the unit test of the device layer: out[i] = in[i] * factor + i + offset.
 *
 * Both buffers are windowed: they are indexed from 0 in every slice.
 */
#version 460

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint factor = 1;
layout(constant_id = 2) const uint each = 1; /* elements per invocation */

layout(binding = 0) readonly buffer Input { uint value[]; };
layout(binding = 1) writeonly buffer Output { uint result[]; };

layout(push_constant) uniform Push {
	uint first, count; /* gw_span */
	uint offset;
};

void main()
{
	for (uint k = 0; k < each; k++) {
		uint i = gl_GlobalInvocationID.x * each + k;
		if (i < count)
			result[i] = value[i] * factor + first + i + offset;
	}
}
