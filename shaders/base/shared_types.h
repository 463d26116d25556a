/*
 * shared_types.h - lets one text define a struct, or a function of numbers, for C, C++ and GLSL.
 *
 * Structs in the shared headers are push-constant blocks. They hold uint, float and vec4 only, each
 * at an offset that std430 and C agree on (a bare vec3 would not be); SHARED_OFFSET checks each on
 * the C side.
 */
#ifndef SHARED_TYPES_H
#define SHARED_TYPES_H

#ifdef VULKAN /* GLSL, set by the shader compiler */

#define SHARED_STRUCT(name) struct name
#define SHARED_SIZE(name, bytes)
#define SHARED_OFFSET(name, member, offset)
#define SHARED_FUNCTION(type) type
#define float_of(number) float(number)

#else

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus

#include "base/glsl.h"

#define SHARED_STRUCT(name) struct name

#else

typedef uint32_t uint;
typedef struct vec4 {
	_Alignas(16) float x;
	float y, z, w;
} vec4;

#define SHARED_STRUCT(name)                                                                        \
	typedef struct name name;                                                                      \
	struct name

#endif

#define SHARED_SIZE(name, bytes) static_assert(sizeof(name) == (bytes), #name " has another size")
#define SHARED_OFFSET(name, member, offset)                                                        \
	static_assert(offsetof(name, member) == (offset), #name "." #member " is elsewhere")
#define SHARED_FUNCTION(type) static inline type
#define float_of(number) ((float)(number))

#endif
#endif
