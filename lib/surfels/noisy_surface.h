/*
 * noisy_surface.h - points that noise has spread across their surface by much of what they are
 * apart or more, as those of scanners that are carried along. Internal to lib/.
 *
 * A plane through a dozen neighbours then goes astray, and joining neighbours does not help: they
 * are as often above each other as beside. But planes through all that is around within some five
 * standard deviations of the noise lie within a small part of it, and points are put onto these.
 * What is finer nobody knows. What fills space, as leaves do, or stands above the ground is thicker
 * the wider one looks, and stays.
 */
#ifndef NOISY_SURFACE_H
#define NOISY_SURFACE_H

#include "cloud/neighbours.h"

typedef struct gw_noisy_points {
	const gw_surfels *surfels; /* of the points, with what gw_frame_make fills */
	gw_neighbours *search;     /* of these surfels */
	uint32_t threads;          /* 0 means one a processor */
	uint32_t *some;            /* count, the surfels that are looked at; NULL: all */
	size_t count;
	bool sparse;  /* they are further apart than noise is wide; so what is as near as that on either
					 side of a thin wall is told apart */
	double noise; /* metres, RMS: what was taken out of the places of most */
} gw_noisy_points;

/*
 * Puts points onto the surface that they lie around, where noise is large for their distances; of
 * some that are crowded, those that are nearer to each other than others are become one.
 *   points    of them noise is set
 *   position  3 a point, what the surfels were made of; is changed where points are moved
 *   moved     receives how many surfels were: 0 where noise is small, or there is no surface
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_noisy_surface_flatten(gw_noisy_points *points, double *position, size_t *moved,
								   gw_error *error);

/*
 * Finds surfels that are crowded, several times nearer to each other than most are: as those right
 * above and below a scanner, where noise is wide for them though it is not elsewhere.
 *   points  some and count receive them, NULL where they are too few to matter; owned by the caller
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_crowded_points_find(gw_noisy_points *points, gw_error *error);

#endif
