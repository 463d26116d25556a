/*
 * las_step.h - --las-step auto: how coarse the grid of coordinates may be that LAS, LAZ and COPC
 * keep, by the points.
 */
#ifndef LAS_STEP_H
#define LAS_STEP_H

#include "options/settings.h"
#include "points/scan.h"
#include "units/coordinates.h"

/* Whether settings ask for such a step that only all points at once tell: it is to be chosen, and
 * no LAS file had one.
 *   said   a scan with the comments of the input */
bool las_step_needs_all(const settings *settings, const scan *said);

/* What it is chosen by. */
typedef struct las_step_points {
	const scan *said;         /* the comments of the input */
	const gw_points *points;  /* NULL: those of said, as they are */
	const coordinates *place; /* what takes said's coordinates to those of points; NULL: nothing */
	uint64_t all;             /* of how many these points are some; 0: there are no others */
} las_step_points;

/*
 * Chooses the step where settings ask for it, puts it into them, and notes it on standard error
 * unless they are quiet: that of the LAS file that came in; else the coarsest power of ten, up to a
 * thousandth, that moves no point by more than a hundredth of the median distance between
 * neighbours; of degrees 1e-9; 0 of points without neighbours. GW_ERROR_MEMORY.
 */
gw_status las_step_settle(settings *settings, const las_step_points *by, gw_error *error);

#endif
