/*
 * error_price.h - what a bake with a smaller error would cost, from what this one measured.
 *
 * Rays make gathered light noisy, and that falls with the root of their number; the rest of its
 * error falls as records come closer, where they are put where they disagree. What a smaller error
 * allows is shared between the two, as refine.h does. Seconds are those of this very bake: what any
 * bake of these points takes, what every round takes, and what goes with the rays. Edges of lamps'
 * shadows are as wrong as the points are far apart, and normals as the scan has them, whatever is
 * paid.
 */
#ifndef ERROR_PRICE_H
#define ERROR_PRICE_H

#include "glowworm.h"

/* What a bake measured. */
typedef struct gw_price_task {
	gw_error_estimate error;
	uint32_t rays;        /* a record, in the end */
	double records;       /* in the end */
	double spacing;       /* with which its first round placed them, leaf cells */
	bool refined;         /* records were added where they disagree */
	double fixed_seconds; /* once a bake, whatever its error */
	double round_seconds; /* once a round, but for the records' rays */
	double ray_seconds;   /* a ray of a record, with all that is done for it */
} gw_price_task;

/* What of an error stays whatever is paid: that of shadows' edges, normals, emitters' power, the
 * octree, gaps, sides, narrow things and of points between those of the surface. */
double gw_error_floor(const gw_error_estimate *error);

/*
 * What of gathered light would be wrong with so many times as many records, spread evenly as those
 * of the error: noise of the rays stays, the rest falls.
 *   spread   receives by how much scenes differ in that
 */
double gw_error_with_records(const gw_error_estimate *error, double times, double *spread);

/* What half of the error would cost, or where what stays does not allow that, half of the error of
 * gathered light; 0.99 where that is more, which no max_error can be. All 0 where that
 * would be hardly less, nothing would bring it, or nothing is known. */
gw_price gw_price_of_less(const gw_price_task *task);

/* What would bring the error and its spread down to `error`. Seconds are 0 where nothing would. */
gw_price gw_price_of(const gw_price_task *task, double error);

#endif
