/*
 * near_duplicates.h - points that stand hardly off each other, many times nearer than all others:
 * the first and the last return of one pulse, one place in two flight lines or scans. Internal to
 * lib/.
 *
 * What lies between two such points is noise, and not surface; but it is the nearest neighbour of
 * either, and decides how far apart points seem to be. So where a cloud has many, they are made
 * one. Of random points on a surface some stand close to each other, too, and stay as they are.
 */
#ifndef NEAR_DUPLICATES_H
#define NEAR_DUPLICATES_H

#include "cloud/neighbours.h"

/* Which are joined: near duplicates, or whatever is each other's nearest neighbour. */
typedef enum gw_near_duplicates_kind {
	GW_NEAR_DUPLICATES,
	GW_NEAREST_PAIRS
} gw_near_duplicates_kind;

/*
 * Puts the points of such surfels in one place, half way, so that a frame made anew takes them for
 * one. Those whose normals differ, as of two sides of a sheet, and those that emit stay.
 *   surfels   of the points, with what gw_frame_make fills
 *   search    of these surfels
 *   position  3 a point, what the surfels were made of; is changed where there are near duplicates
 *   moved     receives how many surfels were
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_near_duplicates_join(const gw_surfels *surfels, gw_neighbours *search,
								  gw_near_duplicates_kind kind, double *position, size_t *moved,
								  gw_error *error);

/* Whether a cloud has so many near duplicates that they matter, by the order of the surfels alone.
 */
bool gw_near_duplicates_are_many(const gw_surfels *surfels);

#endif
