/*
 * albedo_places.h - places of a scan in which neighbours are asked for their level: cubes, and the
 * points in each.
 */
#ifndef ALBEDO_PLACES_H
#define ALBEDO_PLACES_H

#include "glowworm.h"

/* A point in its place. */
typedef struct albedo_member {
	int32_t at[3];  /* which cube */
	uint32_t group; /* what else keeps points of one cube apart */
	size_t point;
} albedo_member;

/*
 * Width of the cubes that hold about 30 points each, if these were spread over a sphere in the
 * bounds of their bulk, whatever strays there are; in the unit of the positions, 0 where all points
 * are at one place.
 *   low  receives where a cube has its least corner
 */
double albedo_place_width(const gw_points *points, double low[3]);

/*
 * Finds the cube of a point.
 *   p      its position; low, width: of albedo_place_width
 *   at     receives the cube
 * Returns false when it has none: positions that are not finite or far off all others, no width.
 */
bool albedo_place_find(const double p[3], const double low[3], double width, int32_t at[3]);

/* Whether a level, 3 channels, has a logarithm; where next to no light falls it may be infinite. */
bool albedo_level_known(const float level[3]);

/* Sorts by cube, then group, then point. */
void albedo_members_sort(albedo_member *list, size_t count);

/* The end of the members, in a sorted list, that are in the cube of the first. */
size_t albedo_members_end(const albedo_member *list, size_t first, size_t count);

#endif
