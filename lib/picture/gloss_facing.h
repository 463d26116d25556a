/*
 * gloss_facing.h - a function of shaders/picture/glossy.glsl for C.
 */
#ifndef GLOSS_FACING_H
#define GLOSS_FACING_H

#include "base/shader_math.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A surface's normal on the eye's side: face_eye(). Both unit. */
gw_vec3 gw_gloss_facing(gw_vec3 normal, gw_vec3 to_eye);

#ifdef __cplusplus
}
#endif

#endif
