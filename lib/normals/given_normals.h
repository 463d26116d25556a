/*
 * given_normals.h - normals that came with the points but cannot be right. Internal to lib/.
 *
 * Looked for, mostly on a sample of the surfels:
 *
 * - lengths: most are so short that no surface spreads its normals so far. They are taken as
 *   directions alone.
 * - directions: many normals are far from perpendicular to the plane through their neighbours,
 *   where those lie on a plane; such as one normal for all. None of them is then believed.
 * - signs: many normals oppose their neighbours' on the same plane, or those beyond a crease. Signs
 *   are then found as those of estimated normals are, and each component of surface keeps the side
 *   that clearly most of its given normals had.
 * - away: nearly all points of a scanner face away from it. These are turned.
 * - inside out: a closed body whose fronts see nothing but each other, with no lamp, emitter or
 *   scanner within. All are turned.
 *
 * Of normals without a side only directions are looked at. None of them counts as given afterwards:
 * gw_normals_complete turns them.
 *
 * Normals in which none of this is found stay as they are, to the bit. Thin sheets whose sides both
 * have points are no fault: there the opposing neighbours lie behind.
 */
#ifndef GIVEN_NORMALS_H
#define GIVEN_NORMALS_H

#include "cloud/neighbours.h"

/*
 * Mends surfels->normal as options->normals says: 0, 0, 0 stands for those to be estimated. Fills
 * normals_turned, normals_doubted and normals_lengthened.
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_given_normals_mend(const gw_points *points, const gw_surfels_options *options,
								gw_neighbours *search, gw_surfels *surfels, gw_error *error);

#endif
