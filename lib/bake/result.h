/*
 * result.h - from the light of surfels to that of points.
 */
#ifndef RESULT_H
#define RESULT_H

#include "bake/lighting.h"

/* Fills in the arrays of points, and counts those without light. */
gw_status gw_result_collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error);

/* What each light gives, into given; again when it was told before. Skies and what emits are known
 * after the read back, until then they give nothing. */
gw_status gw_result_share_light(gw_lighting *lighting, gw_bake_result *result, gw_error *error);

/* L of the points alone: 3 * point_count floats. */
gw_status gw_result_radiance(gw_lighting *lighting, float *radiance, gw_error *error);

/* Fills in the voxels; afterwards the records' indirect light holds all gathered light. */
gw_status gw_result_collect_voxels(gw_lighting *lighting, gw_bake_result *result, gw_error *error);

/* Lights the scene by each light alone and by the points that emit, and fills in lamp and rest. The
 * records' light is lost. */
gw_status gw_result_collect_lamps(const gw_lighting *lighting, gw_bake_result *result,
								  gw_error *error);

#endif
