/*
 * shader_functions.h - functions of shaders/ for C: rays of records, and rays to lamps.
 */
#ifndef SHADER_FUNCTIONS_H
#define SHADER_FUNCTIONS_H

#include "base/shader_math.h"
#include "light/transport_layout.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Direction of the k-th of a record's gather rays: record_ray.glsl. */
gw_vec3 gw_record_ray(gw_vec3 g, gw_vec3 normal, uint32_t k, uint32_t rays, uint32_t seed);

/* How much of such a ray's light has to be left for it to go on: record_ray.glsl. */
float gw_record_chance(gw_vec3 g, uint32_t k, uint32_t seed);

/* A light as the texts of shaders take it. */
typedef struct gw_lamp {
	gw_light_push push;
	const float *distribution; /* gw_light.distribution */
} gw_lamp;

/* Irradiance that a light sends to a place with that normal, over its intensity or irradiance;
 * where it is from there, and how far: light.glsl. */
float gw_lamp_received(const gw_lamp *lamp, gw_vec3 g, gw_vec3 normal, gw_vec3 *towards,
					   float *distance);

/* Direction of the s-th ray, of lamp->push.samples, to a place of the light, or of the disc that it
 * shows.
 *   turn       by how much the places are turned, in turns
 *   towards    its middle, at that distance
 *   range      receives how far the place is; far away for suns */
gw_vec3 gw_lamp_aim(const gw_lamp *lamp, uint32_t s, float turn, gw_vec3 towards, float distance,
					float *range);

#ifdef __cplusplus
}
#endif

#endif
