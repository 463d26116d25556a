/*
 * record_ray.glsl - direction of a record's k-th gather ray. Uses `push`, a gw_record_push.
 */
#ifndef RECORD_RAY_GLSL
#define RECORD_RAY_GLSL

vec3 record_ray(vec3 normal, uint record, uint k, out float cosine)
{
	uint own = hash2(record, push.seed);
	float turn = unit_float(own);
	float u = unit_float(hash2(own, k));
	return disc_to_hemisphere(spiral_disc(k, push.rays, u, turn), normal, cosine);
}

#endif
