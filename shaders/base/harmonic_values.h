/*
 * harmonic_values.h - values of the real spherical harmonics of bands 0 to 2, and how a cosine lobe
 * weighs them, for C, C++ and GLSL. Order and signs are those of lib/base/spherical_harmonics.h.
 */
#ifndef HARMONIC_VALUES_H
#define HARMONIC_VALUES_H

#include "base/shared_types.h"

/* Most harmonics of an expansion: bands 0 to 2. */
#define GW_HARMONICS_MOST 9u

/* The j-th harmonic, j below GW_HARMONICS_MOST, in the unit direction (x, y, z). */
SHARED_FUNCTION(float) harmonic_value(uint j, float x, float y, float z)
{
	if (j < 4u)
		return j == 0u   ? 0.282094792f
			   : j == 1u ? 0.488602512f * y
			   : j == 2u ? 0.488602512f * z
						 : 0.488602512f * x;
	return j == 4u   ? 1.09254843f * x * y
		   : j == 5u ? 1.09254843f * y * z
		   : j == 6u ? 0.315391565f * (3.0f * z * z - 1.0f)
		   : j == 7u ? 1.09254843f * x * z
					 : 0.546274215f * (x * x - y * y);
}

/* What the j-th harmonic of radiance is multiplied by to be that of irradiance: pi, 2 pi / 3 and
 * pi / 4 for bands 0, 1 and 2 (Ramamoorthi and Hanrahan 2001, equation 8). */
SHARED_FUNCTION(float) harmonic_cosine(uint j)
{
	return j == 0u ? 3.14159265f : j < 4u ? 2.09439510f : 0.785398163f;
}

#endif
