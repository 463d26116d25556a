/*
 * plan.h - which effects a scene calls for, why, and how each is computed. An effect that is not
 * called for costs nothing: no pass, no buffer, no shader.
 *
 * What is decided here needs no octree: lights, their cones, albedo, emission, and what of the
 * result is asked for. It does not depend on the order of the points.
 */
#ifndef PLAN_H
#define PLAN_H

#include "cloud/surfels.h"

typedef struct gw_plan {
	bool lamps;            /* point, spot or sun lights shine on points */
	bool shadows;          /* and surfaces hide them */
	bool emitters;         /* some surfel emits */
	bool sky;              /* the environment is not black */
	const gw_light *map;   /* the environment light with a map, or NULL */
	bool portals;          /* openings to the sky are looked for */
	bool bounces;          /* light is reflected more than once */
	bool records;          /* anything is gathered at all */
	bool gaps;             /* what nobody scanned is looked for */
	bool error;            /* the error is estimated */
	bool octree;           /* any of these needs it */
	bool octree_asked;     /* it is needed for something else than light */
	float sky_radiance[3]; /* sum of the environment lights without a map */
	uint32_t limit;        /* reflections, or GW_BOUNCES_AUTO */
} gw_plan;

/* What is to be planned; nothing of it is owned. */
typedef struct gw_plan_task {
	const gw_surfels *surfels;
	const gw_light *lights; /* light_count */
	size_t light_count;
	const gw_bake_options *options; /* gw_options_effective */
} gw_plan_task;

/* Decides, and writes the decisions and their reasons into the report. */
void gw_plan_make(const gw_plan_task *task, gw_plan *plan, gw_report *report);

/* Whether any light could call for something that is gathered, and for an octree, by what the
 * options forbid: for scenes whose lights are not known yet. Options as of gw_options_effective. */
bool gw_plan_may_gather(const gw_bake_options *options);
bool gw_plan_may_trace(const gw_bake_options *options);

/* Do records keep what their rays hit? */
static inline bool gw_method_keeps_hits(gw_method method)
{
	return method == GW_METHOD_RAYS || method == GW_METHOD_PROBES;
}

/* Does light go through the cells of a uniform grid? */
static inline bool gw_method_has_cells(gw_method method)
{
	return method == GW_METHOD_VOLUME || method == GW_METHOD_LPV;
}

/* Whether an effect is forced. */
bool gw_effect_forced(const gw_bake_options *options, gw_effect_kind effect);

#endif
