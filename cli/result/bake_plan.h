/*
 * bake_plan.h - what a bake is going to compute, why, and what it will take, for people and as
 * JSON; and beside it what came of that.
 */
#ifndef BAKE_PLAN_H
#define BAKE_PLAN_H

#include "scene/loaded_scene.h"
#include "program/json_writer.h"

/* Asks for the columns of lamps where their effect is forced. */
void bake_plan_apply_effects(settings *settings);

/* Leaves all where it is without its path where motion is forbidden. GW_ERROR_USAGE where it is
 * forced and there are no frames for it. */
gw_status bake_plan_apply_motion(settings *settings, gw_error *error);

/* The library's options for a bake by these settings: columns and grids call for some of them. */
gw_bake_options bake_plan_options(const settings *settings);

/* Adds the effects to a report that its library does not know of: gloss and motion. */
void bake_plan_add_scene(gw_report *report, const settings *settings, const loaded_scene *scene);

/* What is foretold of the whole program, reading included and writing not. */
typedef struct bake_plan_forecast {
	const settings *settings;
	const loaded_scene *scene;
	const gw_bake_result *plan; /* of gw_plan_bake, or what the library plans; with the effects of
								   bake_plan_add_scene */
	uint32_t following;         /* frames after the first */
	double read_seconds;
	uint64_t host_bytes;   /* resident memory of the process at its highest */
	uint64_t device_bytes; /* likewise of the device */
} bake_plan_forecast;

/* To be called when the library says that it has planned.
 *   row_bytes    of a written point, 0 where none is written
 *   following    frames after the one that is planned */
bake_plan_forecast bake_plan_foretell(const settings *settings, const loaded_scene *scene,
									  const gw_bake_result *plan, double read_seconds,
									  size_t row_bytes, uint32_t following);

/* Prints which effects are called for, at what price, why and how; what each light gives; and what
 * is foretold of the whole. */
void bake_plan_print(const bake_plan_forecast *forecast, FILE *out);

/* Prints what came of a bake, when it is done: the figures of bake_plan_print, in their order.
 *   seconds   of reading and baking, without what foretelling took */
void bake_plan_print_outcome(const gw_report *came, double seconds, FILE *out);

/* The members "plan" and "forecast" of an object. */
void bake_plan_write_effects(json_writer *json, const gw_report *report);
void bake_plan_write_forecast(json_writer *json, const bake_plan_forecast *forecast);

#endif
