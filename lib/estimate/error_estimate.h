/*
 * error_estimate.h - how wrong a bake is, found by solving some points again.
 *
 * Some points gather for themselves: many rays and many samples of the emitters, from the point's
 * own place and normal, with directions that the records did not use. What the bake says at these
 * points is then compared with what they found. That sees the noise of the records and what
 * interpolating between them and stopping the bounces cost. It does not see what the octree's
 * planes leave of the geometry, because these rays meet the same planes: 0.25 to 0.4 % RMS on
 * scenes of 100,000 points with known answers; the spread has a tenth of the error for that. The
 * points are drawn at random, more of them where errors are likely (check_point_choice.h).
 * What lamps send to the places that the rays meet they take from the lamps themselves, as facets
 * have that of the few points in them (hit_light.h). What all points are off alike is so again in
 * each reflection.
 *
 * Each point gathers twice with half of the rays. Half of the two halves' mean square difference is
 * the variance of one half; a quarter of it is the noise of their mean, which is taken off the mean
 * square error.
 *
 * Added to that is what edges of lamps' shadows are off (shadow_error.h), and what the normals that
 * lamps shine on are off where points are noisy or had none (normal_error.h), and what the edges of
 * emitters do to their power (emission_error.h). What is wrong with the octree itself, rays find
 * that meet nothing of it (geometry_error.h); they also find what surfaces cost that may face the
 * wrong way (side_error.h), and plates that stand for narrow things (narrow_error.h).
 */
#ifndef ERROR_ESTIMATE_H
#define ERROR_ESTIMATE_H

#include "light/gather_rays.h"
#include "estimate/check_discs.h"
#include "estimate/check_point_hits.h"
#include "light/read_back.h"
#include "surfels/scanned_space.h"

typedef struct gw_estimate_task {
	gw_passes *passes;
	const gw_octree *octree;
	const gw_surfels *surfels;
	/* Solved: first and indirect are final; NULL where lamps alone shine, and then what follows up
	 * to bounces is not looked at, nor are first and indirect. */
	gw_records *records;
	const gw_read_back *read_back; /* from the records to the surfels */
	const gw_ray_gather *rays_of_records;
	const gw_emitters *emitters;   /* count 0 when nothing emits */
	const gw_buffer *facet_direct; /* irradiance of the facets from point, spot and sun lights */
	const float *sky;              /* 3, radiance of the environment */
	const gw_sky_map *map;         /* of the environment, or NULL */
	const gw_portals *portals;     /* through which it shines, or NULL */
	bool bounces;                  /* whether light was reflected more than once */
	const float *direct;           /* 4 a surfel or NULL, irradiance from lamps */
	const float *turned;           /* the same with normals that are off, or NULL */
	const float *first;           /* 4 a surfel, irradiance as the bake found it: unreflected ... */
	const float *indirect;        /* 4 a surfel ... and reflected */
	uint32_t rays, light_samples; /* of a record, above 0 */
	uint32_t points, seed;        /* how many points are solved again, and of their draw */
	uint32_t threads;             /* of the CPU; 0: one a core  */
	const gw_light *lights;       /* light_count: what shines */
	size_t light_count;
	const gw_bake_options *options;
	const bool *asked;              /* NULL, or one a surfel: the error is that of these */
	bool seen;                      /* scanners are known */
	const gw_scanned_space *closed; /* NULL, or whose gaps are closed as options say */
	uint32_t limit;                 /* reflections, or GW_BOUNCES_AUTO */
	double remaining;               /* share of the light that further ones would add */
	gw_check_point_hits *hits;      /* what is known of what points see; theirs in the end */
	gw_check_discs *discs;          /* of the surfels, made when they are needed */
} gw_estimate_task;

/* Rays of each of the two gathers of a point, where a record has so many. */
uint32_t gw_estimate_rays(uint32_t rays);

/* How many points are solved again where `wanted` are asked for: fine bakes, whose errors lie in
 * few places, can afford one for every 20 records, up to four times as many. */
uint32_t gw_estimate_points(uint32_t wanted, uint32_t records);

/* Finds what points see that an estimate of so many points may ask for, whatever will shine. */
gw_status gw_estimate_foresee(const gw_check_point_task *task, uint32_t points,
							  gw_check_point_hits *hits, gw_error *error);

/*
 * Estimates the error of the bake's radiance.
 *   estimate   receives it; all zeros where nothing is lit or no point can be compared. Where lamps
 *              alone shine, no points, but the error of shadows
 */
gw_status gw_estimate_error(const gw_estimate_task *task, gw_error_estimate *estimate,
							gw_error *error);

#endif
