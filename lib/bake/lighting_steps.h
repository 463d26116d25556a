/*
 * lighting_steps.h - what is done to light a scene's records and, from these, its surfels.
 */
#ifndef LIGHTING_STEPS_H
#define LIGHTING_STEPS_H

#include "bake/lighting.h"

/* Light that reaches the records straight from emitters and sky. */
gw_status gw_lighting_gather_first(gw_lighting *lighting, gw_error *error);

/* What is reflected, until it does not matter; fills the report's bounces. */
gw_status gw_lighting_bounce(gw_lighting *lighting, gw_error *error);

/* The records' light at every surfel: surfel_first and surfel_indirect. */
gw_status gw_lighting_read_back(gw_lighting *lighting, gw_error *error);

/* These steps after the plan, with the direct light. */
gw_status gw_lighting_run(gw_lighting *lighting, gw_error *error);

#endif
