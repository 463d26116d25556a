/*
 * pass.glsl - what the texts of passes are written with that are compiled as GLSL and as C++; here
 * for GLSL, in glsl.h and lib/light/kernel.cpp for C++. The README.md of shaders/ says more.
 *
 *   TEXELS(binding, texel, name)           a texel buffer of uint, uvec2, uvec4, float or vec4
 *   BUFFER(binding, access, type, name)    a storage buffer, `name` an array of that type
 *   PUSH(type)                             the push-constant block, `push`
 *   CONSTANT(id, type, name, value)        a specialisation constant, and what it is without one
 *   IN(type), OUT(type), INOUT(type)       parameters: `in`, `out` and `inout` of GLSL
 *   vec3a, ivec3a, vec4a                   vectors that C++ keeps in one register, without .x
 */
#ifndef PASS_GLSL
#define PASS_GLSL
#ifdef VULKAN

#define TEXELS_uint usamplerBuffer
#define TEXELS_uvec2 usamplerBuffer
#define TEXELS_uvec4 usamplerBuffer
#define TEXELS_float samplerBuffer
#define TEXELS_vec4 samplerBuffer
#define TEXELS(slot, texel, name) layout(binding = slot) uniform TEXELS_##texel name
#define BUFFER(slot, access, type, name)                                                           \
	layout(binding = slot) access buffer Buffer##slot                                              \
	{                                                                                              \
		type name[];                                                                               \
	}
#define readwrite
#define PUSH(type)                                                                                 \
	layout(push_constant) uniform Push                                                             \
	{                                                                                              \
		type push;                                                                                 \
	}
#define CONSTANT(id, type, name, value) layout(constant_id = id) const type name = value

#define IN(type) type
#define OUT(type) out type
#define INOUT(type) inout type
#define vec3a vec3
#define ivec3a ivec3
#define vec4a vec4

layout(local_size_x_id = 0) in;

#endif
#endif
