/*
 * forecast.h - what a bake will take, before it takes it: light is gathered at some hundred places
 * of the real octree, and what goes with the number of places is taken times as many.
 */
#ifndef FORECAST_H
#define FORECAST_H

#include "bake/lighting.h"

/* The spacing of records that leaves few of so many. */
float gw_pilot_spacing(uint64_t records, float spacing);

/* Seconds of passes over records: they take as long a record, however many there are. */
double gw_pilot_record_seconds(gw_passes *passes);

/* Bytes on the device that go with the number of records: of these, and of what their rays hit. */
uint64_t gw_pilot_record_bytes(const gw_scene *scene);

/*
 * Foretells the rest of a bake.
 *   lighting   its octree stands and its lamps have been lit; on return it is as it was
 *   done       seconds of the stages so far
 *   plan       its report is that of the scene and receives the forecast, of which places is 0
 *              where nothing is gathered, and the prices of effects; it is told what each light
 *              gives
 *   light      NULL, or empty, and receives what so few records gave: the light of the points and,
 *              in its report, the error of that and the spacing of these records; to be destroyed
 *              by the caller, also on failure
 * Fails as the stages themselves do, then the lighting is to be cleared.
 */
gw_status gw_forecast_make(gw_lighting *lighting, double done, gw_bake_result *plan,
						   gw_bake_result *light, gw_error *error);

#endif
