/*
 * test_faults.comp - for the unit test of the device layer: reads and writes where it is told to,
 * so that a test can plant what validation must report.
 */
#version 460

layout(local_size_x_id = 0) in;

layout(binding = 0) readonly buffer Input { uint value[]; };
layout(binding = 1) writeonly buffer Output { uint result[]; };

layout(push_constant) uniform Push {
	uint first, count;           /* gw_span */
	uint read_shift, write_shift; /* elements past an invocation's own */
};

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= count)
		return;
	result[i + write_shift] = value[i + read_shift];
}
