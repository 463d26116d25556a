/*
 * albedo_remainder.h - light that the set-up does not know of: what still varies smoothly along a
 * surface after the known light was divided out.
 *
 * The retinex of images (Land and McCann 1971; Horn 1974, "Determining lightness from an image") on
 * places of a scan: between neighbours on one surface a small difference of logarithms belongs to
 * the light, a large one to the albedo; the light is the field whose differences are the small
 * ones.
 */
#ifndef ALBEDO_REMAINDER_H
#define ALBEDO_REMAINDER_H

#include "glowworm.h"

/*
 * Divides the smooth remainder out of the levels of each connected surface, whose mean level stays.
 *   points   their positions
 *   normal   3 * count, unit length: of the surface
 *   left     count: points that are not zero here are left as they are, and not asked
 *   level    3 * count, in the order of the points; 0 where nothing is known
 *   typical  receives by what share of itself the light changed, the mean over what was asked
 * GW_ERROR_MEMORY.
 */
gw_status albedo_remainder_divide(const gw_points *points, const float *normal, const uint8_t *left,
								  float *level, double *typical, gw_error *error);

#endif
