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

#include "device/passes.h"

/* Bakes points as they are given, on a device that is lent: gw_bake_once. */
typedef gw_status gw_half_bake(const gw_scene_description *scene, const gw_bake_options *options,
							   gw_gpu **device, const gw_bake_callbacks *callbacks,
							   gw_bake_result **result, gw_error *error);

/* The whole bake. */
typedef struct gw_half_forecast_task {
	gw_half_bake *bake;
	const gw_scene_description *scene;
	const gw_bake_options *options;     /* checked and effective (scene.h) */
	const gw_bake_callbacks *callbacks; /* asked whether it is cancelled; told nothing */
	gw_gpu *device;                     /* lent to the bake of half of the points, with what it
										   has in use; the caller's again on return */
} gw_half_forecast_task;

/*
 * Adds it to a forecast.
 *   light    of the points as few records found it, with its error and the spacing of these records
 *            in the report (gw_forecast_make)
 *   report   its forecast and the reason for the effect `error` are changed. Where half of the
 *            points find no memory beside the whole bake, they say so, and that the error is the
 *            least; where half of them are no cloud, nothing changes but own_seconds, and the bake
 *            will add nothing either.
 * Fails as a bake does, but for these two.
 */
gw_status gw_half_forecast_add(const gw_half_forecast_task *task, const gw_bake_result *light,
							   gw_report *report, gw_error *error);

#endif
