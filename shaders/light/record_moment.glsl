/*
 * record_moment.glsl - how a record's irradiance changes where its normal turns: what each
 * direction brings, times the tangent of its angle to the normal, along the two tangents of
 * tangent_frame(normal) (the rotational gradient of Ward and Heckbert 1992; with the irradiance
 * along the normal, the first moment of what the record saw).
 *
 * Tangents have no bound near the horizon, where few directions would decide all: they end at
 * GW_TANGENT_MOST.
 */
#ifndef RECORD_MOMENT_GLSL
#define RECORD_MOMENT_GLSL

#include "light/record_ray.glsl"

/* What light counts along both tangents; p: its direction along them, by its cosine. */
vec2 moment_share(vec2 p, float cosine)
{
	return p * (1.0f / max(cosine, sqrt(dot(p, p)) / GW_TANGENT_MOST));
}

/* Of light from a direction. */
vec2 moment_share_of(vec3 normal, vec3 direction)
{
	vec3 t, b;
	tangent_frame(normal, t, b);
	return moment_share(vec2(dot(direction, t), dot(direction, b)), dot(direction, normal));
}

/* Of light along the k-th gather ray of a record. */
vec2 moment_share_of_ray(vec3 g, uint k)
{
	vec2 p = record_ray_disc(g, k);
	return moment_share(p, sqrt(max(0.0f, 1.0f - dot(p, p))));
}

#endif
