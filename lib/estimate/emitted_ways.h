/*
 * emitted_ways.h - on which ways emitted light comes to records: how much of it through gaps, and
 * through what is solid, where surface is missing that would have stopped it.
 *
 * Ways go from each record to some of the points that emit, drawn by their power. Only of a record
 * that has ways through gaps or solids is it asked which of all its ways are free: by rays through
 * the points' discs (check_discs.h). And where records look through gaps and solids it is looked
 * from there which emitters would light the surface that is missing. Of many records that is done
 * at every so many-th: what is asked are means over them.
 */
#ifndef EMITTED_WAYS_H
#define EMITTED_WAYS_H

#include "base/luminance.h"
#include "estimate/check_discs.h"
#include "light/gather_rays.h"
#include "surfels/scanned_space.h"

typedef struct gw_emitted_ways {
	float gap, solid; /* shares of the light that comes straight from what emits: 0..1 together */
	/* How much emitted light falls on what is missing where a record looks through gaps and solids,
	 * by some measure, as a mean over its rays; and the sum of its squares over the rays. */
	float lost, squares;
} gw_emitted_ways;

typedef struct gw_emitted_ways_task {
	gw_record_context on;
	const gw_surfels *surfels; /* some emit */
	const gw_scanned_space *space;
	const gw_ray_gather *rays;   /* of the records */
	const gw_check_discs *discs; /* open */
	uint32_t threads;
	size_t step; /* records are looked at whose number is a multiple of this: at least 1 */
} gw_emitted_ways_task;

/* What a surfel that may emit sends to one side, over pi: W, as luminance. */
static inline double gw_emitted_power(const gw_surfels *s, size_t surfel)
{
	return (double)s->area[surfel] * gw_luminance(s->emission + 3 * surfel);
}

/* ways   one a record; zeros for those that are not looked at */
gw_status gw_emitted_ways_find(const gw_emitted_ways_task *task, gw_emitted_ways *ways,
							   gw_error *error);

#endif
