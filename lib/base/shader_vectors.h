/*
 * shader_vectors.h - vectors of C as those of the texts of shaders/, and back. For C++ files that
 * take in such texts.
 */
#ifndef SHADER_VECTORS_H
#define SHADER_VECTORS_H

#include "base/shader_math.h"
#include "base/shared_math.h"

namespace glsl
{

inline vec3 from_c(gw_vec3 v)
{
	return vec3(v.x, v.y, v.z);
}

inline gw_vec3 to_c(vec3 v)
{
	return gw_vec3{ v.x, v.y, v.z };
}

} // namespace glsl

#endif
