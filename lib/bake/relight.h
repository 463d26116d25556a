/*
 * relight.h - one lighting of a solver: what depends on lamps, emission and sky.
 *
 * The steps, in this order:
 *
 *   plan -> direct light -> first gather -> bounces -> read back
 *
 * They may be run again on the same solver with other lights: each step begins with dark buffers.
 * Steps after the direct light need the solver's records and are to be left out unless
 * plan.records.
 */
#ifndef RELIGHT_H
#define RELIGHT_H

#include "bake/plan.h"
#include "bake/solver.h"

typedef struct gw_relight {
	gw_solver *solver;      /* not owned */
	const gw_light *lights; /* light_count, not owned */
	size_t light_count;
	gw_plan plan;
	/* NULL, or this is a part of that lighting: all that depends on how much light there is, is
	 * done as there, so that the parts add up to the whole but for roundings. */
	const struct gw_relight *whole;
	bool kept;                /* parts will follow: keep what they need */
	gw_emitters patches;      /* of the kept: the lit lobes, and */
	gw_buffer patch_radiance; /* what they reflect first */
	bool patches_sampled;     /* whether they were sampled */
	gw_emitters emitters;     /* the lobes that emit */
	gw_sky_map map;           /* of the environment light that has one */
	bool map_made;
	gw_buffer surfel_direct; /* vec4 a surfel: irradiance from lamps */
	gw_buffer surfel_turned; /* the same with normals that are off, where an estimate needs it */
	float *surfel_first, *surfel_indirect; /* 4 a surfel, on the host */
	gw_buffer lobe_direct, lobe_radiance;  /* vec4 a lobe */
	const float *carried; /* NULL, or 4 a surfel, not owned: a guess at surfel_indirect, with which
							 bounces by rays begin */
} gw_relight;

/* Decides which effects these lights call for, and writes it into the solver's report. */
void gw_relight_plan(gw_relight *relight);

/* Decides the same as the whole for a part: for these lights, and the emission of points or not. */
void gw_relight_plan_part(gw_relight *part, bool emission);

/* Light of lamps at every surfel and lobe. */
gw_status gw_relight_direct(gw_relight *relight, gw_error *error);

/* Light that reaches the records straight from emitters and sky. */
gw_status gw_relight_gather_first(gw_relight *relight, gw_error *error);

/* What is reflected, until it does not matter; fills the report's bounces. */
gw_status gw_relight_bounce(gw_relight *relight, gw_error *error);

/* The records' light at every surfel: surfel_first and surfel_indirect. */
gw_status gw_relight_read_back(gw_relight *relight, gw_error *error);

/* All of these steps after the plan. */
gw_status gw_relight_run(gw_relight *relight, gw_error *error);

/* How wrong the light is, into the report. */
gw_status gw_relight_estimate(gw_relight *relight, gw_error *error);

/* Where no error was estimated: finds what points see that an estimate of another lighting may ask
 * for. */
gw_status gw_relight_foresee(gw_relight *relight, gw_error *error);

/* The lamps' light at every surfel; on success *direct is the caller's, 4 floats a surfel. */
gw_status gw_relight_download_direct(const gw_relight *relight, float **direct, gw_error *error);

/* Forget what was gathered; all light. Before the solver drops the records, or the octree. */
void gw_relight_drop_gathered(gw_relight *relight);
void gw_relight_clear(gw_relight *relight);

#endif
