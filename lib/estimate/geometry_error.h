/*
 * geometry_error.h - how wrong the light is because the octree is, by rays that meet nothing of it.
 *
 * The points that an estimate solves again see through the same octree as the records: where that
 * has a hole, leaks or shows the wrong side, both are wrong alike. So some of the records' rays,
 * and rays to the lamps from some of the points, go through the points' discs by themselves
 * (check_discs.h). What a ray brought through the octree is held against what small discs and large
 * ones let it bring, and only what lies outside of what these two say counts.
 *
 * What the places are off one by one adds up in squares. What all are off on average is worse than
 * it looks: light that is lost, or too much, is so in every bounce, and among white walls there are
 * many. It counts as often as light is reflected until it is gone. Of both the noise of the rays is
 * taken off.
 *
 * Rays that leave the scene are few where it is closed, and all that is lost there; up to a number
 * all of them are looked at, of the others one in so many.
 */
#ifndef GEOMETRY_ERROR_H
#define GEOMETRY_ERROR_H

#include "estimate/check_discs.h"
#include "estimate/hit_light.h"
#include "light/gather_rays.h"
#include "light/read_back.h"
#include "surfels/scanned_space.h"

typedef struct gw_geometry_task {
	gw_gpu *gpu;
	const gw_octree *octree;
	const gw_surfels *surfels;
	const gw_check_discs *discs; /* of the surfels */
	const bool *counts;          /* one a surfel: whether its error counts */
	uint32_t seed, threads;

	/* What is gathered: NULL, or by which records. Then the others are there too. */
	const gw_records *records;
	const gw_ray_gather *rays;     /* what their rays hit */
	const gw_read_back *read_back; /* whom they light */
	const gw_buffer
		*facet_radiance; /* what facets reflect in the end, or NULL: nothing that counts */
	const gw_hit_light *hit_light; /* NULL, or what places have beyond their facets */
	const float *radiance;         /* one a surfel: luminance of what it sends out likewise */
	const float *sky;              /* 3, radiance of the environment */
	const gw_sky_map *map;         /* of the environment, or NULL */
	uint32_t limit;                /* reflections, or GW_BOUNCES_AUTO */

	/* What lamps send: NULL, or irradiance, 4 a surfel. */
	const float *direct;
	const gw_light *lights; /* light_count */
	size_t light_count;
	const gw_bake_options *options;
	const gw_scanned_space *closed; /* NULL, or whose gaps hide lamps */
} gw_geometry_task;

/*
 * Finds the root mean square error of the points that count, as luminance of radiance.
 *   rms   receives it; 0 where nothing was found
 */
gw_status gw_geometry_error(const gw_geometry_task *task, double *rms, gw_error *error);

#endif
