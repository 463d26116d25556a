/*
 * side_error.h - how wrong the light is because parts of surface may face the wrong way.
 *
 * Where normals were estimated, somebody guessed which side of the surface people see. A
 * check is what the sides themselves see: from within a room, or from outside of things, one sees
 * fronts of surfaces, and from within what is solid one sees backs. So from some of the points rays
 * go out on both sides, through the points' discs by themselves (check_discs.h). A ray that leaves
 * a front and meets a back, or the other way round, says that one of the two points is wrong.
 *
 * A ray may also meet a back because the front above it was not scanned, as through the underside
 * of what stands on a floor. Then the points beside know better: of a smooth component of surface
 * (side_components.h) no more points are wrong than all of its rays together say.
 *
 * If a share w of the points is wrong wherever they are, a share 2 w (1 - w) of all rays says so,
 * which gives w. A point is wrong with a probability that puts together w and what its own rays
 * say. What that costs is the difference between the light of its two sides, both found by the same
 * rays. Points that are lit from both sides, because nobody knows theirs, are wrong half of the
 * time, unless their rays know better.
 */
#ifndef SIDE_ERROR_H
#define SIDE_ERROR_H

#include "estimate/check_discs.h"
#include "estimate/check_light.h"

/* So many points are looked from, and as many again where some are lit from both sides: these are
 * few, and one of them may be off by more than hundreds of others. */
#define GW_SIDE_POINTS 384u

typedef struct gw_side_task {
	gw_gpu *gpu;
	const gw_octree *octree;
	const gw_surfels *surfels;
	const gw_check_discs *discs; /* of the surfels */
	const bool *asked;           /* NULL, or one a surfel: points whose light is asked for */
	bool seen;                   /* scanners are known that saw the sides that are shown */
	uint32_t seed, threads;
	const float *radiance;  /* one a surfel: luminance of what it sends out, or NULL: nothing */
	bool whole;             /* that is all of it, the light of lamps as well */
	gw_sky_view sky;        /* where there is radiance */
	uint32_t limit;         /* reflections, or GW_BOUNCES_AUTO */
	const gw_light *lights; /* light_count: lamps; 0 where they are not looked at */
	size_t light_count;
	const gw_bake_options *options;
} gw_side_task;

typedef struct gw_side_finding {
	double rms; /* root mean square error of the points that do not emit, luminance of radiance */
	double spread; /* standard error of that */
	double share;  /* of the points that are likely to face the wrong way */
} gw_side_finding;

gw_status gw_side_error(const gw_side_task *task, gw_side_finding *found, gw_error *error);

/* Lists the lamps that shine, for check rays: each is asked by a few of its samples.
 *   lamp   receives them; room for light_count
 * Returns how many. */
size_t gw_side_lamps(const gw_side_task *task, gw_lamp *lamp);

#endif
