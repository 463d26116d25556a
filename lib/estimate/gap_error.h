/*
 * gap_error.h - how much of the light hangs on gaps, where no scanner ever looked, and how wrong it
 * is if these are surfaces like those around them.
 *
 * A record that sees gaps in a share of its directions is off by the difference between what they
 * send now and what the rest of its directions send on average. That is brought to the points as
 * the records' light is; what is off on average is so in every reflection, and most where reflected
 * light is bright.
 *
 * Where beams went out of the scene in the middle of others that found something, and no sky is
 * there to shine, nobody knows whether that is a window or a surface that sent nothing back. As one
 * is as likely as the other, the error is sqrt(1/2) of what a surface would bring.
 *
 * The same holds for gaps where no scanner is known, which are holes of the surface. Where a sky
 * shines through them, one of them at least is a window: with k of them each is none with a
 * probability of (1/2 - 2^-k) / (1 - 2^-k), and then what comes through it, from sky, lamps and
 * suns, should not be there.
 *
 * What emits is a surface with holes of its own, and where no scanner is known its light is looked
 * at by itself. A hole in it may emit as its rim does. Light that comes to records through holes,
 * or through what is solid between surfaces that turn their backs to each other (solid_cells.h),
 * would not if surface was there; what enters there is lost, and would be reflected to where
 * records look through it (emitted_ways.h). Of holes that is as likely so as not; of solids it is
 * sure.
 *
 * What a lamp sends to such places is missing in all that is reflected. No point would tell, so
 * rays go out from the lamps, through the points' discs (check_discs.h).
 */
#ifndef GAP_ERROR_H
#define GAP_ERROR_H

#include "estimate/check_discs.h"
#include "light/gap_light.h"
#include "light/read_back.h"

typedef struct gw_gap_error_task {
	gw_record_context on; /* the records are solved: first and indirect are final */
	const gw_surfels *surfels;
	const bool *asked; /* NULL, or one a surfel: those whose light is asked for */
	const gw_scanned_space *space;
	const gw_read_back *read_back;
	const gw_gap_sight *gap;       /* one a record */
	const gw_ray_gather *rays;     /* theirs */
	const float *direct;           /* 4 a surfel, irradiance from lamps, or NULL */
	const float *first, *indirect; /* 4 a surfel: gathered irradiance */
	const gw_light *lights;        /* light_count */
	size_t light_count;
	uint32_t limit; /* reflections, or GW_BOUNCES_AUTO */
	const gw_bake_options *options;
	gw_check_discs *discs; /* of the surfels, made when they are needed */
} gw_gap_error_task;

/*
 *   report   receives all but the scanners
 *   estimate receives gaps, which is added to its relative_rms
 */
gw_status gw_gap_error(const gw_gap_error_task *task, gw_gap_report *report,
					   gw_error_estimate *estimate, gw_error *error);

#endif
