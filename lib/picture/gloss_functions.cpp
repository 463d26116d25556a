/*
 * gloss_functions.cpp - see gloss_functions.h. As in kernel.cpp the text of the shader becomes the
 * body of a struct.
 */
#include "picture/gloss_functions.h"

namespace glsl
{
namespace
{

struct gloss {
#include "picture/glossy.glsl"
};

vec3 of(gw_vec3 v)
{
	return vec3(v.x, v.y, v.z);
}

gw_vec3 of(vec3 v)
{
	return gw_vec3{ v.x, v.y, v.z };
}

} // namespace
} // namespace glsl

gw_vec3 gw_gloss_facing(gw_vec3 normal, gw_vec3 to_eye)
{
	glsl::gloss text;
	return glsl::of(text.face_eye(glsl::of(normal), glsl::of(to_eye)));
}

uint32_t gw_gloss_rays(const gw_gloss_seen *seen, uint32_t most)
{
	glsl::gloss text;
	float cosine = glsl::dot(glsl::of(seen->normal), glsl::of(seen->to_eye));
	return text.gloss_rays(seen->roughness, text.fresnel(seen->reflectance, cosine), most);
}

gw_vec3 gw_gloss_direction(const gw_gloss_seen *seen, uint32_t own, uint32_t k, float *share)
{
	glsl::gloss text;
	return glsl::of(text.reflected_direction(glsl::of(seen->normal), glsl::of(seen->to_eye),
											 seen->roughness, seen->reflectance,
											 text.gloss_place(own, k), *share));
}

uint32_t gw_gloss_word(uint32_t pixel, uint32_t seed)
{
	return pcg_hash2(pixel, seed);
}
