/*
 * refine.h - what comes next when a bake's error is still too large.
 *
 * A bake that has a target solves and estimates its error. As long as that helps, it adds records
 * where those that there are disagree (record_density.h); all that was traced stays. Then it solves
 * again with settings that attack the larger part of what is left: noise of the rays
 * (GW_ESTIMATE: the halves of a check point's rays disagree, and so will records) asks for more
 * rays, the rest for more records, and when those stand as dense as the leaves, for narrower
 * leaves. When a round did not help, the next one attacks both; when that does not help either,
 * what is left is not a matter of settings and more work would be in vain. Edges of shadows and
 * what else no setting lessens (gw_error_floor) may alone be more than the target: rounds go on
 * then only until gathered light is less wrong than that.
 *
 * A bake that has none places few records where points are many, and adds some where these disagree
 * until gathered light is as right as the quality asks for: gw_refine_gathered. A round that has
 * not helped ends it, unless records are fewer than any bake of default settings begins with.
 */
#ifndef REFINE_H
#define REFINE_H

#include "bake/record_density.h"

/* What is known when a round is over. */
typedef struct gw_refine_state {
	const gw_bake_options *options; /* of the round; leaf_spacing is not GW_LEAF_SPACING_AUTO */
	gw_error_estimate error;        /* that it made */
	double round_seconds;           /* from placing records to the estimate */
	double octree_seconds;          /* the octree and the direct light, where they were last made */
	bool crowded;                   /* records stand as close as they may */
	bool trial;                     /* light that misses its target is worth nothing */
	const gw_round *round;          /* round_count rounds so far, this one the last; may be NULL */
	uint32_t round_count;
	float least_spacing; /* that added records keep, leaf cells */
	double seconds_left; /* for the next one; INFINITY where time does not matter */
} gw_refine_state;

typedef enum gw_refine_answer {
	GW_REFINE_ROUND,        /* go on with *next */
	GW_REFINE_NO_TIME,      /* even a small step would take longer than what is left */
	GW_REFINE_EXHAUSTED,    /* all settings are at their limits */
	GW_REFINE_STALLED,      /* the last two rounds have not lessened the error */
	GW_REFINE_OUT_OF_REACH, /* more than what is asked for stays, whatever is paid */
} gw_refine_answer;

/* What error->relative_rms plus the spread has to be under; 0 when no target is given. Whether it
 * is. Never where there is no estimate. */
bool gw_refine_reached(const gw_bake_options *options, const gw_error_estimate *error);

/*
 * Whether to add records for the light that is gathered, until options->gathered_error is reached
 * or other settings would have to help; and how many. wish, why   as below
 */
gw_refine_answer gw_refine_gathered(const gw_refine_state *state, gw_density_wish *wish,
									char why[96]);

/*
 * Whether to add records, and how many.
 *   wish   receives what the error is to be brought down to; left alone unless GW_REFINE_ROUND is
 *          returned. GW_REFINE_EXHAUSTED: other settings have to help
 *   why    receives a phrase for reports, at most 95 bytes
 */
gw_refine_answer gw_refine_records(const gw_refine_state *state, gw_density_wish *wish,
								   char why[96]);

/*
 * Chooses the next settings.
 *   next   receives a copy of state->options with larger rays, light_samples or cones, or smaller
 *          record_spacing or leaf_spacing; left alone unless GW_REFINE_ROUND is returned
 *   why    receives a phrase for reports, at most 95 bytes
 */
gw_refine_answer gw_refine_next(const gw_refine_state *state, gw_bake_options *next, char why[96]);

#endif
