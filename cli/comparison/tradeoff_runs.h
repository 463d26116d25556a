/*
 * tradeoff_runs.h - one scene baked at many settings, each in a process of its own, so that its
 * peak memory is its own.
 */
#ifndef TRADEOFF_RUNS_H
#define TRADEOFF_RUNS_H

#include "glowworm_picture.h"
#include "scene/loaded_scene.h"
#include "options/progress.h"

/* What is to be tried, and what came of it. */
typedef struct tradeoff_run {
	char name[32];         /* "rays normal", "rays normal, rays x 4" */
	char options[128];     /* that give it on the command line of bake */
	gw_bake_options bake;  /* the same for the library */
	gw_status status;      /* GW_ERROR_MEMORY: it did not fit; GW_ERROR_DATA: these points have no
							  place for it; the figures are not there then */
	double seconds;        /* of the bake, without reading */
	uint64_t host_bytes;   /* resident memory of the process at its highest, the scene included */
	uint64_t device_bytes; /* memory on the device at its highest; part of the above where the
							  device is the processor */
	gw_error_estimate estimate; /* that the bake made of itself */
	gw_comparison difference;   /* of the luminance from that of the reference; the reference's own
								   is all zeros */
	bool front;                 /* no other run is both as fast and as near */
} tradeoff_run;

#define TRADEOFF_RUNS 21

typedef struct tradeoff {
	tradeoff_run run[TRADEOFF_RUNS]; /* the first is the reference */
	size_t count;
} tradeoff;

/* Fills in what is to be tried: qualities and what lies between them, by rays, by cones, by
 * radiance and light propagation volumes and by probes. base: all options that the sweep does not
 * set. */
void tradeoff_plan(const gw_bake_options *base, tradeoff *tradeoff);

/*
 * Bakes all of them, one after the other, and compares them with the first, over the points that
 * do not emit (over all, when all do).
 *   error  of the reference, whatever it is; of another run, anything but GW_ERROR_MEMORY and
 *          GW_ERROR_DATA
 */
gw_status tradeoff_bake(const loaded_scene *scene, const gw_light *lights, size_t light_count,
						tradeoff *tradeoff, progress *shown, gw_error *error);

#endif
