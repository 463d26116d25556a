/*
 * normal_error.h - what errors of the normals do to the light of lamps.
 *
 * How far off the normals are is known (shading_normals.h, plane_error.h), but not which way. So
 * lamps shine once more, without looking for shadows again, on normals that are turned by as much;
 * the mean square of what that changes is that of the error. Where a surfel lies in the plane of
 * another whose normal differs, as beside a crease, it is likely that one which it should have:
 * then it is turned all the way there, as often as makes the mean square angle what it is.
 * Elsewhere it is turned in a random direction.
 */
#ifndef NORMAL_ERROR_H
#define NORMAL_ERROR_H

#include "cloud/surfels.h"

/*
 * Turns the normal of a surfel that lamps shine on; shading_normal_off is there.
 *   turned   receives it, unit
 */
void gw_normal_turn(const gw_surfels *surfels, size_t surfel, float turned[3]);

/*
 * Mean over the counted surfels of the squared difference of reflected luminance.
 *   direct   4 a surfel, irradiance from lamps
 *   turned   4 a surfel, the same with turned normals
 *   counts   one a surfel: whether its error counts
 * Returns (W/(sr m^2))^2; 0 when none counts.
 */
double gw_normal_error(const gw_surfels *surfels, const float *direct, const float *turned,
					   const bool *counts);

#endif
