/*
 * tangent_frame.cpp - gw_tangent_frame of surfels.h: tangent_frame of sampling.glsl for C.
 */
#include "cloud/surfels.h"

#include "base/shared_math.h"

namespace glsl
{
namespace
{

struct sampling {
#include "base/sampling.glsl"
};

} // namespace
} // namespace glsl

void gw_tangent_frame(const float normal[3], float tangent[3], float bitangent[3])
{
	glsl::vec3 t, b;
	glsl::sampling().tangent_frame(glsl::vec3(normal[0], normal[1], normal[2]), t, b);
	memcpy(tangent, &t, sizeof t);
	memcpy(bitangent, &b, sizeof b);
}
