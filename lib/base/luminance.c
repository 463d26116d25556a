/*
 * luminance.c - see luminance.h.
 */
#include "base/luminance.h"

#include "glowworm.h"

double gw_relative_luminance(double red, double green, double blue)
{
	return GW_LUMINANCE_RED * red + GW_LUMINANCE_GREEN * green + GW_LUMINANCE_BLUE * blue;
}
