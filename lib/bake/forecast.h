/*
 * forecast.h - what a bake will take, before it takes it: light is gathered at some hundred places
 * of the real octree, and what goes with the number of places is taken times as many.
 */
#ifndef FORECAST_H
#define FORECAST_H

#include "bake/lighting.h"

/*
 * Foretells the rest of a bake.
 *   lighting   its octree stands and its lamps have been lit; on return it is as it was
 *   done       seconds of the stages so far
 *   plan       its report is that of the scene and receives the forecast, of which places is 0
 * where nothing is gathered, and the prices of effects; it is told what each light gives Fails as
 * the stages themselves do, then the lighting is to be cleared.
 */
gw_status gw_forecast_make(gw_lighting *lighting, double done, gw_bake_result *plan,
						   gw_error *error);

#endif
