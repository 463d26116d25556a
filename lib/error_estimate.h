/*
 * error_estimate.h - how wrong a bake is, found by solving some points again.
 *
 * Points drawn at random gather for themselves: many rays and many samples of the emitters, from
 * the point's own place and normal, with directions that the records did not use. What the bake
 * says at these points is then compared with what they found. That sees the noise of the records
 * and what interpolating between them and stopping the bounces cost. It does not see what the
 * octree's planes leave of the geometry, because these rays meet the same planes.
 *
 * Each point gathers twice with half of the rays. Half of the two halves' mean square difference is
 * the variance of one half; a quarter of it is the noise of their mean, which is taken off the mean
 * square error.
 *
 * Added to that is what edges of lamps' shadows are off (shadow_error.h), and what the normals that
 * lamps shine on are off where points are noisy or had none (normal_error.h).
 */
#ifndef ERROR_ESTIMATE_H
#define ERROR_ESTIMATE_H

#include "gather_rays.h"

/* The points that are solved again: what they see depends on the geometry alone. */
typedef struct gw_probes {
	uint32_t points, seed; /* as asked for */
	uint32_t count;        /* those that can be compared */
	uint32_t *surfel;      /* count, ascending */
	gw_records place;      /* position and normal of each, and what it gathers */
	gw_ray_gather rays[2]; /* of each of the two gathers */
	gw_buffer sampled[2];  /* what the points that emit brought, once it is known */
} gw_probes;

/* Draws and traces `points` probes. On success to be freed with gw_probes_destroy. */
gw_status gw_probes_make(gw_passes *passes, const gw_octree *octree, const gw_surfels *surfels,
						 uint32_t points, uint32_t seed, gw_probes *probes, gw_error *error);
/* How the probes of a seed gather, without their hits. */
gw_ray_gather gw_probes_rays(uint32_t seed, int half);
void gw_probes_destroy(gw_gpu *gpu, gw_probes *probes);

typedef struct gw_estimate_task {
	gw_passes *passes;
	gw_probes *probes;
	const gw_octree *octree;
	const gw_surfels *surfels;
	const gw_records *records;    /* solved: first and indirect are final */
	const gw_emitters *emitters;  /* count 0 when nothing emits */
	const gw_buffer *lobe_direct; /* irradiance of the lobes from point, spot and sun lights */
	const float *sky;             /* 3, radiance of the environment */
	const gw_sky_map *map;        /* of the environment, or NULL */
	const gw_openings *openings;  /* through which it shines, or NULL */
	bool bounces;                 /* whether light was reflected more than once */
	const float *direct;          /* 4 a surfel or NULL, irradiance from lamps */
	const float *turned;          /* the same with normals that are off, or NULL */
	const float *first;           /* 4 a surfel, irradiance as the bake found it: unreflected ... */
	const float *indirect;        /* 4 a surfel ... and reflected */
	uint32_t rays, light_samples; /* of a record, above 0 */
	uint32_t threads;             /* of the host; 0: one a core */
} gw_estimate_task;

/*
 * Estimates the error of the bake's radiance.
 *   estimate   receives it; all zeros where nothing is lit or no point can be compared
 */
gw_status gw_estimate_error(const gw_estimate_task *task, gw_error_estimate *estimate,
							gw_error *error);

#endif
