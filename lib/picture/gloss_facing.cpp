/*
 * gloss_facing.cpp - see gloss_facing.h. As in kernel.cpp the text of the shader becomes the body
 * of a struct.
 */
#include "picture/gloss_facing.h"

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
	glsl::gloss of;
	glsl::vec3 n = of.face_eye(glsl::vec3(normal.x, normal.y, normal.z),
							   glsl::vec3(to_eye.x, to_eye.y, to_eye.z));
	return gw_vec3{ n.x, n.y, n.z };
}
