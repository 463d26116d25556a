/*
 * surface_points.h - a surface of some of the points, where there are more than memory holds or
 * than its user wants to wait for.
 *
 * Light is smooth and scans are dense: a cave scanned every two millimetres is lit no better than
 * one scanned every eight, but for the edges of shadows. So surface, octree and records are made of
 * as many points as there may be, and the others are lit by them (surface_light.h).
 *
 * Points in rows and columns are thinned by whole rows and columns. Of the others one is taken out
 * of each cube of a grid that is as fine as the number allows, or one of those in it that face the
 * same of its sides, so that those are thinned most that are densest: what stands beside a scanner,
 * and where scans overlap. Which it is, a hash of their places says, whatever their order; the one
 * nearest to the middle would follow the grid, not the surface.
 *
 * Each takes the mean albedo, emission and opacity of all that it stands for, so that as much is
 * emitted and reflected as before: of those in its cube or, where something emits, of those that it
 * is the nearest of (surface_owners.h), in rows and columns as well.
 */
#ifndef SURFACE_POINTS_H
#define SURFACE_POINTS_H

#include "bake/bake_memory.h"
#include "bake/point_subset.h"

/* Bytes that the bake of a surface may take beside the program and all points, of
 * gw_bake_options.memory or most of what there is now; 0: it does not say how many points there may
 * be, or nobody knows. */
uint64_t gw_surface_points_memory(const gw_points *points, const gw_bake_options *options);

/* Bytes that a process takes at most that bakes all of so many points, of the program and its
 * drivers as well, as far as can be told of most clouds; see gw_points_in_memory. */
uint64_t gw_memory_of_points(uint64_t points, bool normals, bool lamps,
							 const gw_bake_options *options);

/* How many points the surface may be made of: gw_bake_options.surface_points, or what is likely to
 * fit into so much memory (bake_memory.h); at least as many as there are where all may. */
size_t gw_surface_points_most(const gw_scene_description *scene, const gw_bake_options *options,
							  uint64_t memory);

/* How much such a bake may take; its bytes are 0 where that is not known. */
gw_memory_ceiling gw_surface_points_ceiling(const gw_bake_options *options, uint64_t memory);

/* How many to take after a bake of more than fit into its memory. */
size_t gw_surface_points_fewer(uint64_t fit);

/*
 * How many to try next where an error is asked for: fewer points first, since light is smooth; then
 * sixteen times as many, which have a quarter of the error at best.
 *   tried   of how many a bake was made, 0: none yet
 *   error   that it stated, of which wanted is asked for
 *   most    returned where no fewer are worth a bake of their own
 */
size_t gw_surface_points_next(size_t tried, double error, double wanted, size_t most);

/*
 * Takes about so many of the points; none of those of which it is known that they belong to no
 * surface.
 *   most      1 or more; of points in rows and columns half as many may be left, because these are
 *             thinned by whole numbers
 *   threads   0: one a core
 *   surface   to be freed with gw_point_subset_clear, also on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_surface_points_choose(const gw_points *points, size_t most, uint32_t threads,
								   gw_point_subset *surface, gw_error *error);

/*
 * Gives points that were taken the mean albedo, emission and opacity of those that they stand for;
 * what is no number counts as it does for gw_bake.
 *   owner   one a point of all: the place in the surface of that which stands for it, or
 *           GW_OWNER_NONE (surface_owners.h)
 * Returns false, with nothing changed, when memory is short.
 */
bool gw_surface_points_take_means(const gw_points *all, const uint32_t *owner,
								  gw_point_subset *surface);

/* Which of the six sides of a cube a point faces, 0..5, so that sheets and edges within one keep
 * what is on each side; 6 where it has no normal. normal   3, of any length, or NULL */
int64_t gw_facing_side(const float *normal);

#endif
