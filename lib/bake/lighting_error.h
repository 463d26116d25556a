/*
 * lighting_error.h - how wrong a lighting is.
 */
#ifndef LIGHTING_ERROR_H
#define LIGHTING_ERROR_H

#include "bake/lighting.h"

/* How wrong the light is, into the report. */
gw_status gw_lighting_estimate(gw_lighting *lighting, gw_error *error);

/* Where no error was estimated: finds what points see that an estimate of another lighting may ask
 * for. */
gw_status gw_lighting_foresee(gw_lighting *lighting, gw_error *error);

#endif
