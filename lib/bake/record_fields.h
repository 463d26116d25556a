/*
 * record_fields.h - what the records know of the points besides their light.
 */
#ifndef RECORD_FIELDS_H
#define RECORD_FIELDS_H

#include "bake/lighting.h"

/*
 * Fills in result->ambient_occlusion, result->bent_normal, result->unknown and result->error, where
 * the options ask for them.
 *
 * Ambient occlusion: rays leave a record with a density that follows the cosine, so the share of
 * them that meets nothing within the distance is ambient light, 1 on a free plane. Points
 * interpolate it like light. A point without a record near holds 1, nothing being known that hides
 * it.
 *
 * Bent normal: the mean of these open rays, interpolated likewise and made a unit vector; it is the
 * direction that ambient light comes from, weighted by the cosine, in the points' coordinates. (H.
 * Landis, Production-Ready Global Illumination, SIGGRAPH 2002 course 16.)
 *
 * Error: with weights w that sum to 1, the variance of the records around a point is
 * V = sum w (E - mean)^2 / (1 - sum w^2), and that of their mean V sum w^2. Where one record alone
 * speaks, all that it gathered counts as uncertain. Times rho / pi, as luminance.
 */
gw_status gw_record_fields_collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error);

#endif
