/*
 * spherical_harmonics.c - see spherical_harmonics.h.
 */
#include "base/spherical_harmonics.h"

#include "base/harmonic_values.h"

#include <assert.h>

void gw_spherical_harmonics(const float direction[3], int order, float *value)
{
	assert(order >= 1 && order <= 3);
	for (uint32_t j = 0; j < (uint32_t)(order * order); j++)
		value[j] = harmonic_value(j, direction[0], direction[1], direction[2]);
}
