/*
 * unit_places.h - places of surfels in about unit size, as searches want them: times a power of
 * two, so that nothing is rounded and squares neither overflow nor underflow. Internal to lib/.
 */
#ifndef UNIT_PLACES_H
#define UNIT_PLACES_H

#include "cloud/surfels.h"

#include <math.h>

/* The power of two that makes the bounds of surfels of about unit size. */
static inline double gw_unit_scale(const gw_surfels *surfels)
{
	float extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmaxf(extent, surfels->maximum[k] - surfels->minimum[k]);
	return extent > 0 ? ldexp(1, -ilogb((double)extent)) : 1;
}

/* The place of one of them, times that scale. */
static inline void gw_unit_place(const gw_surfels *surfels, size_t surfel, double scale,
								 float place[3])
{
	for (size_t k = 0; k < 3; k++)
		place[k] = (float)((double)surfels->position[3 * surfel + k] * scale);
}

#endif
