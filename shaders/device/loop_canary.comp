/*
 * loop_canary.comp - how often a loop of one invocation runs: software drivers end long ones and
 * say nothing. What each step makes of the last one shows that it was run, not reckoned.
 */
#version 460

layout(local_size_x_id = 0) in;

layout(binding = 0) writeonly buffer Output { uint counted[]; }; /* steps, and their outcome */

layout(push_constant) uniform Push {
	uint first, count; /* gw_span */
	uint loops;
};

void main()
{
	if (gl_GlobalInvocationID.x >= count)
		return;
	uint steps = 0, state = 1;
	while (steps < loops) {
		state = state * 1664525u + 1013904223u;
		state ^= state >> 13;
		steps++;
	}
	counted[2 * gl_GlobalInvocationID.x] = steps;
	counted[2 * gl_GlobalInvocationID.x + 1] = state;
}
