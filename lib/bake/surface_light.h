/*
 * surface_light.h - the light of all points by a surface that is made of some of them; see
 * surface_points.h.
 *
 * A point takes the irradiance of the points of the surface around that face its way, weighed by
 * how near they are (modified Shepard interpolation, Franke and Nielson 1980), and reflects it by
 * its own albedo. What they know besides, such as occlusion and normals, it takes likewise.
 *
 * How much light changes between the points of the surface, these tell by themselves: each is
 * compared with what the others around it would have it be. Those are about a spacing away, the
 * points in between are nearer. Where light changes it does so at edges, and how many of these lie
 * between a point and its nearest grows with their distance, and so does the square of the error.
 */
#ifndef SURFACE_LIGHT_H
#define SURFACE_LIGHT_H

#include "bake/point_subset.h"

typedef struct gw_surface_light_task {
	const gw_points *points;        /* all */
	const gw_point_subset *surface; /* of which result is */
	const uint8_t *asked;           /* one a point of all, or NULL: all */
	bool estimated;                 /* given normals are not to be used */
	uint32_t threads;               /* 0: one a core */
} gw_surface_light_task;

/*
 * Makes of the light of a surface that of all points, and adds to its estimate of the error what
 * lies between the points of the surface.
 *   result   as gw_bake_once left it for the surface; on failure still so
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_surface_light_spread(const gw_surface_light_task *task, gw_bake_result *result,
								  gw_error *error);

/* Says in a report how many of all points are lit by how many others (report->surface_points), and
 * why: a phrase. */
void gw_surface_light_count(uint64_t all, const char *why, gw_report *report);

/* Says of a report that an error that was asked for is missed, if it is.
 *   wanted   gw_bake_options.max_error; 0: none was */
void gw_surface_light_hold_against(double wanted, gw_report *report);

#endif
