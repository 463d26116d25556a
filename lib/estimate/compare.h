/*
 * compare.h - how far one lighting of a cloud is from another one, and which points are the same.
 *
 * The measure of this project: relRMSE is the root of the mean square of the difference over the
 * points, divided by the mean of the truth. A mean square is decided by a few points that touch a
 * lamp or a hard shadow's edge, so the same figure without the worst hundredth stands beside it;
 * bias is what is left when errors of both signs have cancelled.
 *
 * Everything here only reads its arguments. Thread-safe.
 */
#ifndef COMPARE_H
#define COMPARE_H

#include "glowworm.h"

/* Which share of the points gw_comparison.best_99 leaves out: count / GW_COMPARE_WORST, rounded
 * down. */
#define GW_COMPARE_WORST 100u

/* No partner, in a match. */
#define GW_COMPARE_NONE SIZE_MAX

/* The difference of one quantity. All but the means are shares of truth_mean, 1 meaning 100 %;
 * they are infinite when the truth is dark and the other is not. */
typedef struct gw_comparison {
	uint64_t points;
	double mean, truth_mean; /* in the quantity's unit */
	double rel_rmse;         /* RMS of the difference / truth_mean */
	double best_99;          /* the same over all points but the worst hundredth, and still divided
								by the mean of all */
	double bias;             /* mean / truth_mean - 1 */
	double percentile_50;    /* of the difference without its sign: nearest-rank percentiles */
	double percentile_95, percentile_99;
	double maximum;
} gw_comparison;

/*
 * Compares `count` values with their truths.
 *
 *   found, truth  count values; not finite is GW_ERROR_DATA
 *   count         0 is GW_ERROR_DATA
 *   comparison    receives the figures; left alone on failure
 */
gw_status gw_compare(const double *found, const double *truth, size_t count,
					 gw_comparison *comparison, gw_error *error);

/*
 * Finds to each of `count` keys the place of the equal one among `among_count`, all of them
 * `width` numbers wide (3 for positions, 1 for an index). Equal means equal as numbers, so -0 is 0;
 * a key with a NaN equals none. Where several are equal, the first finds the first, the second the
 * second, so that the same cloud in the same order finds itself; those that are too many find none.
 *
 *   key, among  width * count and width * among_count numbers
 *   width       1 to 3
 *   match       receives `count` places, or GW_COMPARE_NONE
 *   missing     receives how many found none
 *   error       GW_ERROR_MEMORY
 */
gw_status gw_compare_match(const double *key, size_t count, const double *among, size_t among_count,
						   size_t width, size_t *match, size_t *missing, gw_error *error);

/*
 * The places of the `wanted` largest magnitudes, largest first; among equal ones the smaller place
 * is first.
 *
 *   value   count of them, without NaN
 *   place   receives min(wanted, count) places
 */
gw_status gw_compare_worst(const double *value, size_t count, size_t wanted, size_t *place,
						   gw_error *error);

#endif
