/*
 * free_balls.h - balls of free space that touch the surface at two places or more: their centres
 * are the medial axis of that space (Ma, Bae and Choi 2012; Wang 2018, section 3.1.2).
 */
#ifndef FREE_BALLS_H
#define FREE_BALLS_H

#include "cloud/neighbours.h"

typedef struct gw_free_ball {
	float centre[3]; /* metres in the surfels' frame */
	float radius;    /* metres, to the nearest surfel */
} gw_free_ball;

typedef struct gw_free_ball_task {
	const gw_surfels *surfels;
	gw_neighbours *search;        /* of them */
	float minimum[3], maximum[3]; /* metres in their frame: where centres may lie */
	float least;                  /* metres, smallest radius that is kept */
	size_t seeds;                 /* surfels that balls are grown from, at most */
	size_t most;                  /* balls, at most */
	uint32_t threads;             /* 0: one a processor */
} gw_free_ball_task;

/*
 * Grows a ball in front of every surfel, or of as many as task->seeds, evenly chosen: as large as
 * the bounds allow, then shrunk until no other surfel is in it. A surfel that is seen from the
 * first one's place under a small angle is noise of the same surface and stops that. Of balls whose
 * centres lie well within a larger one's, only that one stays.
 *   balls   on success the caller's, for free(), the largest first; NULL when there is none
 *   count   receives how many
 * Fails with GW_ERROR_MEMORY. The balls do not depend on the number of threads.
 */
gw_status gw_free_balls_find(const gw_free_ball_task *task, gw_free_ball **balls, size_t *count,
							 gw_error *error);

/* The distance from a place, metres in the surfels' frame, to the nearest surfel. Thread-safe. */
float gw_free_distance(gw_neighbours *search, const float place[3]);

/* Does a place, as above, lie behind the surfel that is nearest to it? Not where that has two
 * sides. Thread-safe. */
bool gw_free_is_behind(const gw_surfels *surfels, gw_neighbours *search, const float place[3]);

#endif
