/*
 * gloss_functions.h - functions of shaders/picture/glossy.glsl for C.
 */
#ifndef GLOSS_FUNCTIONS_H
#define GLOSS_FUNCTIONS_H

#include "base/shader_math.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A surface's normal on the eye's side: face_eye(). Both unit. */
gw_vec3 gw_gloss_facing(gw_vec3 normal, gw_vec3 to_eye);

/* A glossy surface and who looks at it. */
typedef struct gw_gloss_seen {
	gw_vec3 normal, to_eye; /* unit; the normal on the eye's side */
	float roughness, reflectance;
} gw_gloss_seen;

/* How many rays it takes, of so many at most: gloss_rays(). */
uint32_t gw_gloss_rays(const gw_gloss_seen *seen, uint32_t most);

/* Direction of the k-th of them; own: a word for the pixel; share: how much of the light that comes
 * from there is reflected. reflected_direction(). */
gw_vec3 gw_gloss_direction(const gw_gloss_seen *seen, uint32_t own, uint32_t k, float *share);

/* A number in [0, 1) for that ray: what is less than opaque ends it when no more is left of it. */
float gw_gloss_chance(uint32_t own, uint32_t k);

/* A word for a pixel: pcg_hash2(). */
uint32_t gw_gloss_word(uint32_t pixel, uint32_t seed);

#ifdef __cplusplus
}
#endif

#endif
