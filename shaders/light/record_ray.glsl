/*
 * record_ray.glsl - gather rays of the record at g. Uses push.rays and push.seed.
 */
#ifndef RECORD_RAY_GLSL
#define RECORD_RAY_GLSL

#include "octree/ray.glsl"
#include "base/sampling.glsl"

/* Direction of the k-th, projected on the surface. */
vec2 record_ray_disc(vec3 g, uint k)
{
	uint own = pcg_hash2(pcg_hash_place(g), push.seed);
	float turn = unit_float(own);
	float u = unit_float(pcg_hash2(own, k));
	return spiral_disc(k, push.rays, u, turn);
}

/* Direction of the k-th, and its cosine with the normal. */
vec3 record_ray(vec3 g, vec3 normal, uint k, OUT(float) cosine)
{
	return disc_to_hemisphere(record_ray_disc(g, k), normal, cosine);
}

/* How much of that ray has to be left for it to go on, where surface lets light through. */
float record_chance(vec3 g, uint k)
{
	return stratified(pcg_hash2(pcg_hash_place(g), push.seed ^ GW_OPACITY_SEED), k);
}

/* The k-th gather ray of a record. */
Ray gather_ray(vec3 g, vec3 normal, uint k)
{
	float cosine;
	Ray ray = { g, record_ray(g, normal, k, cosine), normal, g, GW_FAR, false };
	return ray;
}

#endif
