/*
 * half_forecast.h - by how much bakes of half of the points may add to the error that is foretold,
 * from one such bake with few records.
 *
 * With d between all points and half of them, half_sample.h makes of d the error d / sqrt(Q^2 - 1),
 * of which Q takes a bake of a quarter of the points: at the most d, and however little. Few
 * records leave some of d unseen: a tenth, as the spread of every estimate here has. So the error
 * of the whole bake lies between what was foretold without halves and what it is with d and a
 * tenth; the middle of these is foretold, and half of what lies between is a part of the spread.
 */
#ifndef HALF_FORECAST_H
#define HALF_FORECAST_H

#include "glowworm.h"

/*
 * Adds it to a forecast.
 *   scene      of the whole bake
 *   options    of the whole bake, checked and effective (scene.h)
 *   callbacks  of the whole bake, asked whether it is cancelled; told nothing
 *   light      of the points as few records found it, with its error and the spacing of these
 *              records in the report (gw_forecast_make)
 *   forecast   its error and spread are changed, and own_seconds; where half of the points are no
 *              cloud or find no memory it says that the error is the least
 * Fails as a bake does.
 */
gw_status gw_half_forecast_add(const gw_scene_description *scene, const gw_bake_options *options,
							   const gw_bake_callbacks *callbacks, const gw_bake_result *light,
							   gw_forecast *forecast, gw_error *error);

#endif
