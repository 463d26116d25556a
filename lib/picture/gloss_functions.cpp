/*
 * gloss_functions.cpp - see gloss_functions.h. As in kernel.cpp the text of the shader becomes the
 * body of a struct.
 */
#include "picture/gloss_functions.h"

#include "base/shader_vectors.h"
#include "octree/trace_constants.h"

namespace glsl
{
namespace
{

struct gloss {
#include "picture/glossy.glsl"
};

} // namespace
} // namespace glsl

gw_vec3 gw_gloss_facing(gw_vec3 normal, gw_vec3 to_eye)
{
	glsl::gloss text;
	return glsl::to_c(text.face_eye(glsl::from_c(normal), glsl::from_c(to_eye)));
}

uint32_t gw_gloss_rays(const gw_gloss_seen *seen, uint32_t most)
{
	glsl::gloss text;
	float cosine = glsl::dot(glsl::from_c(seen->normal), glsl::from_c(seen->to_eye));
	return text.gloss_rays(seen->roughness, text.fresnel(seen->reflectance, cosine), most);
}

gw_vec3 gw_gloss_direction(const gw_gloss_seen *seen, uint32_t own, uint32_t k, float *share)
{
	glsl::gloss text;
	return glsl::to_c(text.reflected_direction(
		glsl::from_c(seen->normal), glsl::from_c(seen->to_eye), seen->roughness, seen->reflectance,
		text.gloss_place(own, k), *share));
}

float gw_gloss_chance(uint32_t own, uint32_t k)
{
	glsl::gloss text;
	return text.stratified(pcg_hash2(own, GW_OPACITY_SEED), k);
}

uint32_t gw_gloss_word(uint32_t pixel, uint32_t seed)
{
	return pcg_hash2(pixel, seed);
}
