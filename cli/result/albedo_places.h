/*
 * albedo_places.h - places of a scan in which neighbours are asked for their level.
 */
#ifndef ALBEDO_PLACES_H
#define ALBEDO_PLACES_H

#include "glowworm.h"

/*
 * Width of the cubes that hold about 30 points each, if these were spread over a sphere in their
 * bounds; in the unit of the positions, 0 where all points are at one place.
 *   low  receives the least coordinates of all
 */
double albedo_place_width(const gw_points *points, double low[3]);

#endif
