/*
 * cloud_units.h - units of length in which float32 holds the areas of a cloud.
 *
 * Areas of a cloud of 1e-20 m are 1e-40 m^2, less than a float32 has digits for. Multiplied by a
 * power of two, which rounds nothing, such a cloud is like any other.
 */
#ifndef CLOUD_UNITS_H
#define CLOUD_UNITS_H

#include "cloud/surfels.h"

/* The power of two by which the lengths of a cloud so wide, metres, are multiplied: 0 for what is
 * wider than a micrometre, and for 0. */
int gw_length_exponent(double extent);

/* The longest side of the bounds of the finite points, metres; 0 when there are none. */
double gw_cloud_extent(const gw_points *points);

/*
 * A copy of places, 3 * count, multiplied by 2^exponent, for free(); NULL when there is no memory.
 * What is left out for being far stays far, and finite.
 */
double *gw_scaled_places(const double *place, size_t count, int exponent);

#endif
