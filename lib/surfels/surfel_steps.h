/*
 * surfel_steps.h - the steps from points to surfels, one after the other. Internal to lib/.
 *
 *   frame       gw_frame_make        local coordinates, canonical order, duplicates merged
 *   choice      gw_surfels_choose    leaves those that are asked for
 *   neighbours  gw_neighbours_open   a search structure; gw_neighbours_visit goes over all surfels
 *   normals     gw_normals_complete  estimates and orients the normals that are missing
 *   smooth      gw_surfels_smooth    moves noisy points to the surface that they scatter around
 *   disc        gw_discs_make        area, radius, clips, bend, noise and region of influence
 *
 * Every step fills its arrays of gw_surfels; gw_surfels_make frees them when a step fails.
 */
#ifndef SURFEL_STEPS_H
#define SURFEL_STEPS_H

#include "surfels/surfels.h"

/* Least cosine between the normals of points on one surface. */
#define GW_SAME_SURFACE 0.6

/* Coordinates further than this from 0 count as not finite, metres: volumes still fit a float. */
#define GW_COORDINATE_MAX 1e12

/*
 * Bounds of the points that count as finite, metres; returns how many there are. With 0 the bounds
 * are empty: infinity and -infinity.
 */
size_t gw_finite_bounds(const gw_points *points, double minimum[3], double maximum[3]);

/* The length of a normal; 0 when it has no direction: zero, below 1e-20, or not finite. */
double gw_normal_length(const float normal[3]);

/*
 * Fills what follows from the points alone: count, origin, bounds, position, albedo, emission,
 * the given normals (missing ones are 0, 0, 0), normal_length, surfel_of_point and the counts of
 * repairs; allocates two_sided (1 where merged normals oppose each other).
 * Fails with GW_ERROR_DATA when no point is finite or there are more than 2^30, and with
 * GW_ERROR_MEMORY.
 */
gw_status gw_frame_make(const gw_points *points, const gw_surfels_options *options,
						gw_surfels *surfels, gw_error *error);

/*
 * Asks options->choose and takes all other surfels off the arrays that gw_frame_make filled. Bounds
 * and origin stay. All have to have normals, which count as given from then on.
 * Fails as options->choose does, and with GW_ERROR_MEMORY.
 */
gw_status gw_surfels_choose(const gw_surfels_options *options, gw_surfels *surfels,
							gw_error *error);

/* Search structure for the nearest neighbours of surfels. */
typedef struct gw_neighbours gw_neighbours;

/*
 * The surfels nearest to one, by distance and then by index; itself left out. Where the nearest lie
 * on a line, because a scanner's lines are much further apart than the points on them, half of the
 * list is taken from beside the line, from some GW_NEIGHBOURS_WIDE surfels around.
 */
#define GW_NEIGHBOURS_WIDE 128u
typedef struct gw_neighbour_list {
	uint32_t count; /* at most GW_NEIGHBOURS; all others when there are fewer */
	uint32_t index[GW_NEIGHBOURS];
	float distance[GW_NEIGHBOURS]; /* Euclidean, metres, ascending */
	uint32_t complete;             /* the first so many are the nearest of all surfels */
} gw_neighbour_list;

/* How far off a surfel the middle of its neighbours is, of their mean distance: 0 where they lie
 * around it, 1 where they are all in one direction. */
double gw_neighbours_one_sidedness(const gw_surfels *surfels, size_t surfel,
								   const gw_neighbour_list *list);

/* The median of the neighbours' distances to each the nearest other one of them, metres. */
double gw_neighbours_median_gap(const gw_surfels *surfels, const gw_neighbour_list *list);

/* Called once a surfel, from several threads at a time; may write only to that surfel's data. */
typedef void gw_neighbours_visitor(void *user, size_t surfel, const gw_neighbour_list *list);

/*
 * Builds the search structure over surfels->position, which must stay unchanged until it is closed.
 * Lists are kept for further visits (64 bytes a surfel) when options->memory allows, and searched
 * again each time when not.
 *   search    on success to be closed with gw_neighbours_close
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_neighbours_open(const gw_surfels *surfels, const gw_surfels_options *options,
							 gw_neighbours **search, gw_error *error);
void gw_neighbours_close(gw_neighbours *search);

/* For a visitor that finds no memory: the visit that calls it then fails. Thread-safe. */
void gw_neighbours_run_short(gw_neighbours *search);

/* Calls visit for every surfel. Fails with GW_ERROR_CANCELLED or GW_ERROR_MEMORY. */
gw_status gw_neighbours_visit(gw_neighbours *search, gw_neighbours_visitor *visit, void *user,
							  gw_error *error);

/*
 * The exact distance of a surfel to the nearest other one in the maximum norm, metres; infinity
 * when there is no other. Thread-safe; when memory for a longer search is short, the next visit's
 * status says so.
 */
float gw_neighbours_nearest(gw_neighbours *search, size_t surfel, const gw_neighbour_list *list);

/*
 * The GW_NEIGHBOURS_AT surfels, or all when there are fewer, that are nearest to a place.
 *   place   metres, like surfels->position
 *   list    receives them, with their distances from the place
 * Thread-safety and lack of memory are as for gw_neighbours_nearest.
 */
#define GW_NEIGHBOURS_AT 12u
void gw_neighbours_at(gw_neighbours *search, const double place[3], gw_neighbour_list *list);

/*
 * Estimates normals that are 0, 0, 0, orients them and sets two_sided where they cannot be trusted.
 * A normal is that of the plane through the neighbours or, near creases, of a neighbour's plane
 * that the surfel lies on and that is of one face alone. Orientation: to the scanner that saw it,
 * or the one in sight that sees it best when nobody knows; without scanners as normal_orientation.h
 * says.
 */
gw_status gw_normals_complete(const gw_points *points, const gw_surfels_options *options,
							  gw_neighbours *search, gw_surfels *surfels, gw_error *error);

/*
 * Finds the noise of the points. Where it is significant, replaces position and normal by those of
 * the surface that the points scatter around, keeps the normals from before, without their noise,
 * in shading_normal, and fills shading_normal_off and noise. Clean clouds stay as they are; in
 * those partly clean, what lies in clean parts, and points that fill space.
 * filled     count, as gw_filled_space_find finds it
 * search     must have the surfels as they are; when
 * they change it is of no more use smoothed   receives whether anything was replaced Fails with
 * GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_surfels_smooth(gw_neighbours *search, const uint8_t *filled, gw_surfels *surfels,
							bool *smoothed, gw_error *error);

/*
 * Fills nearest, radius, area, clip, bend, creased, spacing and given_area, noise unless it is
 * there, and sets two_sided of surfels that have fewer than three neighbours on their surface.
 *   filled      count, as gw_filled_space_find finds it
 *   rough_area  as in gw_surfels_options
 *   gap         NULL or count floats that receive the Euclidean distance to the nearest other one
 */
gw_status gw_discs_make(gw_neighbours *search, const uint8_t *filled, gw_surfels *surfels,
						bool rough_area, float *gap, gw_error *error);

/* The disc reaches to this neighbour on the surface. */
#define GW_DISC_RANK 8

/*
 * Makes discs narrower that are wider than their neighbours' allow; part of gw_discs_make, see
 * disc_width.c. Changes radius and area.
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_disc_widths_bound(gw_neighbours *search, gw_surfels *surfels, bool rough_area,
							   gw_error *error);

/*
 * Settles where surfaces end that border on nothing: replaces the clips of discs near such
 * boundaries, and forgets boundaries that few surfels see. Part of gw_discs_make; see
 * surfel_boundaries.c. surfels   with all that gw_discs_make fills per surfel; clip, area and
 * creased may change boundary       count, a bit for each clip of a surfel that was taken for a
 * boundary Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_boundaries_settle(gw_neighbours *search, gw_surfels *surfels, bool rough_area,
							   const uint8_t *boundary, gw_error *error);

/* gw_surfels_make that also gives the Euclidean gaps, for free(); gap may be NULL. */
gw_status gw_surfels_make_with_gaps(const gw_points *points, const gw_surfels_options *options,
									gw_surfels *surfels, float **gap, gw_error *error);

#endif
