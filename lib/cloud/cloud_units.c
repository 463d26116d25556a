/*
 * cloud_units.c - see cloud_units.h.
 */
#include "cloud/cloud_units.h"

#include "base/memory.h"
#include "cloud/frame.h"

#include <math.h>

/* Clouds narrower than this, metres, are brought to about 1. */
#define EXTENT_LEAST 0x1p-20

int gw_length_exponent(double extent)
{
	return extent > 0.0 && extent < EXTENT_LEAST ? -ilogb(extent) : 0;
}

double gw_cloud_extent(const gw_points *points)
{
	double low[3], high[3], extent = 0.0;
	if (gw_finite_bounds(points, low, high) == 0)
		return 0.0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, high[k] - low[k]);
	return extent;
}

double *gw_scaled_places(const double *place, size_t count, int exponent)
{
	double *copy = gw_allocate_array(3 * count, sizeof *copy);
	for (size_t i = 0; copy && i < 3 * count; i++) {
		copy[i] = ldexp(place[i], exponent);
		if (!isfinite(copy[i]))
			copy[i] = place[i];
	}
	return copy;
}
