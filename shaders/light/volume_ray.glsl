/*
 * volume_ray.glsl - directions of the rays of a volume's cell: a pattern that shares the sphere
 * evenly, turned at random for each cell. Uses push.seed.
 */
#ifndef VOLUME_RAY_GLSL
#define VOLUME_RAY_GLSL

#include "base/sampling.glsl"

/* How the pattern is turned: where its axes go. */
struct Turn {
	vec3 x, y, z;
};

/* Evenly distributed over all rotations. */
Turn turn_of_cell(vec3 centre)
{
	uint own = pcg_hash2(pcg_hash_place(centre), push.seed);
	float height = 1.0f - 2.0f * unit_float(own);
	float level = sqrt(max(0.0f, 1.0f - height * height));
	float azimuth = 2.0f * GW_PI * unit_float(pcg_hash2(own, 1u));
	float spin = 2.0f * GW_PI * unit_float(pcg_hash2(own, 2u));
	vec3 axis = vec3(level * cos(azimuth), level * sin(azimuth), height), t, b;
	tangent_frame(axis, t, b);
	Turn turn = { t * cos(spin) + b * sin(spin), b * cos(spin) - t * sin(spin), axis };
	return turn;
}

vec3 turned(IN(Turn) turn, vec3 direction)
{
	return turn.x * direction.x + turn.y * direction.y + turn.z * direction.z;
}

#endif
