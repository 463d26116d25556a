/*
 * effect_seconds.h - the price of each effect: the seconds that a bake without it alone would save.
 *
 * What several effects need (the octree, rays, the read back) is saved only with the last of them,
 * so the prices do not add up to the whole.
 */
#ifndef EFFECT_SECONDS_H
#define EFFECT_SECONDS_H

#include "bake/plan.h"
#include "device/passes.h"

/* Seconds of the stages, taken or foretold. */
typedef struct gw_stage_seconds {
	double direct_light, gaps, octree;
	double gather; /* placing records, what reaches them first, reading back */
	double bounces, estimate, columns;
	double emitters, sky, portals; /* of gather, by passes that nothing else needs */
} gw_stage_seconds;

/* Reads the three last from what the passes have booked since `before`, an array of all passes;
 * NULL: since ever. */
void gw_stage_seconds_read(gw_passes *passes, const double *before, gw_stage_seconds *spent);

/* The stages of a bake that is over, or nearly so. */
gw_stage_seconds gw_stage_seconds_of(const gw_report *report, gw_passes *passes);

/* Writes the prices into those effects of the report that it has. */
void gw_effect_seconds_set(const gw_plan *plan, const gw_stage_seconds *spent, gw_report *report);

#endif
