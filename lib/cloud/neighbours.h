/* neighbours.h - the nearest neighbours of surfels. Internal to lib/. */
#ifndef NEIGHBOURS_H
#define NEIGHBOURS_H

#include "base/parallel.h"
#include "cloud/surfels.h"

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
	bool in_rows;                  /* many lists around are lines or strips */
} gw_neighbour_list;

/* How far off a surfel the middle of its neighbours is, of their mean distance: 0 where they lie
 * around it, 1 where they are all in one direction. */
double gw_neighbours_one_sidedness(const gw_surfels *surfels, size_t surfel,
								   const gw_neighbour_list *list);

/* The median of the neighbours' distances to each the nearest other one of them, metres. */
double gw_neighbours_median_gap(const gw_surfels *surfels, const gw_neighbour_list *list);

/* Called once a surfel, from several threads at a time; may write only to that surfel's data, or to
 * what is atomic. */
typedef void gw_neighbours_visitor(void *user, size_t surfel, const gw_neighbour_list *list);

/* Bytes a surfel that the search structure takes at most. For good these are FLANN's copy, its
 * order and ours, and nodes: 25. While it is built there are scaled positions, and of the trees
 * that are under way another copy and FLANN's list of pointers: 12 and at most 20. Where
 * options->memory allows no more, no lists are kept: for a single visit. */
#define GW_NEIGHBOURS_TREE_BYTES 58u

/*
 * Builds the search structure over surfels->position, which must stay unchanged until it is closed.
 * Lists are kept for further visits (64 bytes a surfel) when options->memory allows, and searched
 * again each time when not.
 *   options   are asked until it is closed
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

/* The same in less time: of the distances only the last one of each list is sure to be there. */
gw_status gw_neighbours_visit_reach(gw_neighbours *search, gw_neighbours_visitor *visit, void *user,
									gw_error *error);

/*
 * A loop of another kind over the threads of a search, which stops when a visit would.
 *   count   of what is numbered from 0
 *   work    is handed numbers [first, last), from several threads at a time; what it makes of one
 *           may not depend on what it makes of others
 * Fails with GW_ERROR_CANCELLED.
 */
gw_status gw_neighbours_loop(gw_neighbours *search, size_t count, gw_parallel_work *work,
							 void *user, gw_error *error);

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

#endif
