/*
 * matched_scans.h - two lit clouds, and which point of the one is which point of the other.
 */
#ifndef MATCHED_SCANS_H
#define MATCHED_SCANS_H

#include "points/scan.h"

typedef enum matched_by {
	MATCHED_BY_INDEX,    /* both have a column `index` with the same numbers */
	MATCHED_BY_POSITION, /* the same coordinates in any order: to the last digit, or on the grid of
							the one that was LAS */
	MATCHED_BY_ORDER,    /* as many points, each at the place of its like but for the rounding of
							a format: a millimetre at most, and a 100,000th of their extent */
} matched_by;

/* No partner, among those of a point. */
#define MATCHED_NONE SIZE_MAX

/* "index", "position", "order". */
const char *matched_by_name(matched_by by);

/* Pairs of points. The scans belong to whoever made them and must live as long. */
typedef struct matched_scans {
	const scan *found, *truth;
	const char *found_name, *truth_name; /* for messages */
	matched_by by;
	size_t count;      /* pairs that are compared */
	size_t *in_found;  /* owned; of each pair, the place in found */
	size_t *in_truth;  /* owned */
	size_t emitting;   /* points left out because they emit light */
	size_t not_finite; /* points left out because they are nowhere */
	size_t shared; /* points of the truth at a place, or with a number, that others have, too; */
	size_t untold; /* and those of them that only their light tells from others: shared_places.h
					*/
} matched_scans;

/*
 * Finds the partner of every point of the truth, which may have fewer points than what is compared
 * with it. Points without a finite position are left out, and so are those that emit light (by the
 * truth's columns emission_*, else by the other's), unless all do. Points that share their place
 * are paired as shared_places.h says, unless both clouds have the same places in one order.
 *
 *   match   its scans and names are set by the caller; the rest is filled in, to be freed with
 *           matched_scans_clear
 *   error   GW_ERROR_DATA when a point of the truth has no partner, or no pair is left
 */
gw_status matched_scans_make(matched_scans *match, gw_error *error);

/* Frees what matched_scans_make allocated. */
void matched_scans_clear(matched_scans *match);

#endif
