/*
 * record_ray.glsl - direction of the k-th gather ray of the record at g. Uses push.rays and
 * push.seed.
 */
#ifndef RECORD_RAY_GLSL
#define RECORD_RAY_GLSL

vec3 record_ray(vec3 g, vec3 normal, uint k, out float cosine)
{
	uint own = hash2(hash_place(g), push.seed);
	float turn = unit_float(own);
	float u = unit_float(hash2(own, k));
	return disc_to_hemisphere(spiral_disc(k, push.rays, u, turn), normal, cosine);
}

#endif
