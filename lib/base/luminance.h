/*
 * luminance.h - what an eye makes of linear RGB.
 */
#ifndef LUMINANCE_H
#define LUMINANCE_H

#include "base/shared_math.h"

/* rgb: 3, any linear quantity; the result has its unit. */
static inline double gw_luminance(const float *rgb)
{
	return GW_LUMINANCE_RED * (double)rgb[0] + GW_LUMINANCE_GREEN * (double)rgb[1] +
		   GW_LUMINANCE_BLUE * (double)rgb[2];
}

#endif
