/*
 * surface_owners.h - which point of a surface stands for which of all points: the nearest that
 * faces the same way.
 *
 * The disc of a point of the surface reaches as far as that, so that with the mean emission of
 * those that it stands for it sends out as much as they did. By the means of cubes
 * (surface_points.h), whose points share the discs of others, what a lamp of few discs sends out
 * scatters by a quarter more and up to four fifths.
 */
#ifndef SURFACE_OWNERS_H
#define SURFACE_OWNERS_H

#include "bake/point_subset.h"

#define GW_OWNER_NONE UINT32_MAX

/* Whether a point may be one of the surface: it has a place, shows, and is not known as a stray. */
bool gw_owners_may_have(const gw_points *points, size_t i);

/*
 * Finds them.
 *   surface   of fewer than 2^30 points
 *   threads   that work, 1 or more; the result is the same by any number
 *   owner     points->count, receives them: the row in the surface, or GW_OWNER_NONE of points that
 *             may be none of it
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_owners_find(const gw_points *points, const gw_point_subset *surface, uint32_t threads,
						 uint32_t *owner, gw_error *error);

#endif
