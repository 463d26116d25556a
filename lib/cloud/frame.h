/* frame.h - a local frame: origin, canonical order, duplicates merged. Internal to lib/. */
#ifndef FRAME_H
#define FRAME_H

#include "cloud/surfels.h"

/* Coordinates further than this from 0 count as not finite, metres: volumes still fit a float. */
#define GW_COORDINATE_MAX 1e12

/*
 * Bounds of the points that count as finite, metres; returns how many there are. With 0 the bounds
 * are empty: infinity and -infinity.
 */
size_t gw_finite_bounds(const gw_points *points, double minimum[3], double maximum[3]);

/* The length of a normal; 0 when it has no direction: zero, below 1e-20, or not finite. */
double gw_normal_length(const float normal[3]);

/*
 * Fills what follows from the points alone: count, origin, bounds, position, albedo, emission,
 * the given normals (missing ones are 0, 0, 0), normal_length, surfel_of_point, albedo_of_point and
 * the counts of repairs; allocates two_sided (1 where merged normals oppose each other).
 * Fails with GW_ERROR_DATA when no point is finite or there are more than 2^30, and with
 * GW_ERROR_MEMORY.
 */
gw_status gw_frame_make(const gw_points *points, const gw_surfels_options *options,
						gw_surfels *surfels, gw_error *error);

/*
 * Keeps what each point reflects where that is not what its surfel does: fills albedo_of_point anew
 * from points that surfel_of_point and duplicates tell of. Fails with GW_ERROR_MEMORY.
 */
gw_status gw_frame_keep_albedo(const gw_points *points, gw_surfels *surfels, gw_error *error);

/* Whether what surfels emit lights others. */
bool gw_surfels_emit(const gw_surfels *surfels);

/* Whether one surfel sends out light by itself. */
bool gw_surfel_emits(const gw_surfels *surfels, size_t surfel);

/* How many surfels let light through. */
size_t gw_surfels_count_clear(const gw_surfels *surfels);

#endif
