/*
 * distribution_share.cpp - gw_distribution_share: distribution.glsl for C. As in kernel.cpp its
 * text becomes the body of a struct.
 */
#include "base/distribution.h"

namespace glsl
{
namespace
{

struct luminaire {
	const float *distribution;
#include "base/distribution.glsl"
};

} // namespace
} // namespace glsl

float gw_distribution_share(const float *distribution, uint32_t verticals, uint32_t horizontals,
							gw_vec3 way)
{
	glsl::luminaire of = { distribution };
	return of.distribution_share(verticals, horizontals, glsl::vec3(way.x, way.y, way.z));
}
