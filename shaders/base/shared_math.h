/*
 * shared_math.h - numbers and scalar functions that C, C++ and GLSL have in common.
 */
#ifndef SHARED_MATH_H
#define SHARED_MATH_H

#include "base/shared_types.h"

#define GW_PI 3.14159265358979f

/* Relative luminance of linear RGB, BT.709. Doubles for C, floats for GLSL. */
#define GW_LUMINANCE_RED 0.2126
#define GW_LUMINANCE_GREEN 0.7152
#define GW_LUMINANCE_BLUE 0.0722

/* PCG hash (Jarzynski and Olano 2020): one well-mixed word from one word. */
SHARED_FUNCTION(uint) pcg_hash(uint v)
{
	uint state = v * 747796405u + 2891336453u;
	uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
	return (word >> 22) ^ word;
}

SHARED_FUNCTION(uint) pcg_hash2(uint a, uint b)
{
	return pcg_hash(a ^ pcg_hash(b + 0x9e3779b9u));
}

/* [0, 1), from the upper 24 bits. */
SHARED_FUNCTION(float) unit_float(uint word)
{
	return float_of(word >> 8) * (1.0f / 16777216.0f);
}

#endif
