/*
 * bulk_bounds.h - bounds of a cloud without what lies far off all the rest of it. Internal to lib/.
 *
 * One point of a million that is 1e8 m off, a bird or a return that never was, would make the local
 * frame and the octree's cube so large that all others fall into one cell of them.
 */
#ifndef BULK_BOUNDS_H
#define BULK_BOUNDS_H

#include "cloud/surfels.h"

/*
 * Tightens bounds to the bulk of the points, for as long as few of them lie beyond a gap of three
 * quarters of the bounds along an axis: up to three of them, or one in a thousand, and at most one
 * in sixteen.
 *   minimum, maximum   bounds of all finite points; receive those of the bulk
 * Returns how many finite points lie outside.
 */
size_t gw_bulk_bounds(const gw_points *points, double minimum[3], double maximum[3]);

/* Does a place lie within bounds? */
static inline bool gw_within(const double place[3], const double minimum[3],
							 const double maximum[3])
{
	for (int k = 0; k < 3; k++)
		if (!(place[k] >= minimum[k] && place[k] <= maximum[k]))
			return false;
	return true;
}

#endif
