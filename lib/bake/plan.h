/*
 * plan.h - which effects a scene calls for, why, and how each is computed. An effect that is not
 * called for costs nothing: no pass, no buffer.
 */
#ifndef PLAN_H
#define PLAN_H

#include "cloud/surfels.h"

typedef struct gw_plan {
	bool lamps;            /* point, spot or sun lights shine */
	bool emitters;         /* some surfel emits */
	bool sky;              /* the environment is not black */
	const gw_light *map;   /* the environment light with a map, or NULL */
	bool bounces;          /* light is reflected more than once */
	bool records;          /* anything is gathered at all */
	float sky_radiance[3]; /* sum of the environment lights without a map */
	uint32_t limit;        /* reflections, or GW_BOUNCES_AUTO */
} gw_plan;

/* Decides, and writes the decisions and their reasons into the report. */
void gw_plan_make(const gw_surfels *surfels, const gw_light *lights, size_t light_count,
				  const gw_bake_options *options, gw_plan *plan, gw_report *report);

#endif
