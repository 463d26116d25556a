/*
 * probe_places.h - where probes go (Wang 2018, chapter 3): of the centres of balls of free space
 * as few as see all that any of them sees, then moved by Gibbs sampling until fewer do.
 *
 * Two things are other than in the thesis. Its reward adds up what every probe has of a place
 * (equation 3.2), which leaves each probe by itself and all at the one best spot; here a place
 * counts by the probe that sees it best, and 1 for being seen at all. And a move is accepted by the
 * ratio of what the probe adds to the others after it and before, because the ratio of whole
 * rewards is 1 but for a few thousandths once there are many probes, which accepts anything.
 */
#ifndef PROBE_PLACES_H
#define PROBE_PLACES_H

#include "light/free_balls.h"
#include "light/probe_sight.h"

typedef struct gw_probe_task {
	gw_sight sight;
	gw_neighbours *search;         /* of the surfels */
	const gw_free_ball *candidate; /* candidate_count, in metres */
	size_t candidate_count;
	float minimum[3], maximum[3]; /* metres in the surfels' frame: where probes may stand */
	float least;                  /* metres from the surface at least */
	uint32_t most;                /* probes; 0: as many as it takes */
	uint32_t moves;               /* that Gibbs sampling tries, at most */
	uint32_t seed;
	bool (*cancelled)(void *user); /* asked between moves */
	void *user;
} gw_probe_task;

typedef struct gw_probe_places {
	uint32_t count;
	float *place;          /* 4 * count: grid coordinates, and 0; owned */
	double seeable;        /* share of the surface that any candidate sees */
	double seen;           /* share that probes see */
	uint32_t first;        /* probes that were chosen before any moved */
	uint32_t tried, moved; /* moves */
} gw_probe_places;

/*
 * Chooses places for probes.
 *   places   on success to be cleared with gw_probe_places_clear; empty on failure
 * Fails with GW_ERROR_MEMORY, GW_ERROR_CANCELLED. The same task gives the same places; with 0
 * probes where no candidate sees anything.
 */
gw_status gw_probe_places_choose(const gw_probe_task *task, gw_probe_places *places,
								 gw_error *error);
void gw_probe_places_clear(gw_probe_places *places);

#endif
