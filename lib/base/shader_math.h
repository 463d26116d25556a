/*
 * shader_math.h - vectors of three for C.
 */
#ifndef SHADER_MATH_H
#define SHADER_MATH_H

#include "base/shared_math.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

typedef struct gw_vec3 {
	float x, y, z;
} gw_vec3;

/* The first three of four floats. */
static inline gw_vec3 gw_xyz(const float *four)
{
	return (gw_vec3){ four[0], four[1], four[2] };
}

static inline gw_vec3 gw_plus(gw_vec3 a, gw_vec3 b)
{
	return (gw_vec3){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline gw_vec3 gw_minus(gw_vec3 a, gw_vec3 b)
{
	return (gw_vec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline gw_vec3 gw_times(gw_vec3 a, float factor)
{
	return (gw_vec3){ a.x * factor, a.y * factor, a.z * factor };
}

static inline float gw_dot(gw_vec3 a, gw_vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline float gw_smaller(float a, float b)
{
	return a < b ? a : b;
}

static inline float gw_larger(float a, float b)
{
	return a > b ? a : b;
}

static inline gw_vec3 gw_unit(gw_vec3 a)
{
	return gw_times(a, 1.0f / sqrtf(gw_dot(a, a)));
}

static inline float gw_float_of(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline uint32_t gw_bits_of(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

static inline float gw_luminance_of(gw_vec3 c)
{
	return gw_dot(c, (gw_vec3){ (float)GW_LUMINANCE_RED, (float)GW_LUMINANCE_GREEN,
								(float)GW_LUMINANCE_BLUE });
}

#endif
