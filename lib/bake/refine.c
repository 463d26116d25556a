/*
 * refine.c - see refine.h.
 */
#include "bake/refine.h"

#include "bake/error_price.h"

#include <math.h>
#include <stdio.h>

/* Records nearer to each other than this many leaf cells share the same few facets. */
#define SPACING_LEAST 1.5f

/* On rough surfaces narrower leaves than this get holes, which the estimate does not see. */
#define LEAF_LEAST 1.1f

/* Noise, or the rest, is attacked when it is more than this share of the mean square error. */
#define SHARE_LEAST 0.3

/* A round has helped when it leaves less than this share of the error and its spread. */
#define HELPED 0.95

/* After so many rounds that have not helped, no more are made. */
#define VAIN_MOST 2u

#define RAYS_MOST 4096u

/* A round asks at most for so many times the work of the last one; below SMALLEST it is not worth
 * its fixed costs. */
#define WORK_MOST 16.0
#define WORK_LEAST 1.3

/* Records are aimed at this share of the error that is wanted, since what the estimate says has a
 * spread of its own; and no round makes them more than so many times as many. */
#define AIM 0.9
#define SHARE_MOST 0.75
#define GROWTH_MOST 8.0

/* Where that was done before, what is left is less sure to lie where records disagree. Where no
 * target asks for more, the first time either: most of the error is often that of few places, and
 * an estimate from few points makes much of it. Of a cave of 1.4 million points under a spot 10,651
 * records are 12.2 % off many, 12,700 are 8.9, 18,900 8.4 and 66,000, which were foreseen, 8.3. */
#define GROWTH_AGAIN 2.0

/* Cones have an error of their own that no number of records lessens, and gather at all of them
 * again for every bounce: they get there in steps that do not waste much. */
#define GROWTH_OF_CONES 2.0

/* Records leave the noise of the rays about as it is: they come closer, but as many speak for a
 * point. So when noise alone is more than this share of the mean square error that is wanted, rays
 * come first, as long as records are few; and then they are so many that it is this share. */
#define NOISE_MOST 0.6
#define NOISE_AIM 0.4

/* By how much the parts of the settings are to grow; 1 leaves them alone. */
typedef struct growth {
	double rays, density; /* rays a record; records and leaves along a metre */
} growth;

bool gw_refine_reached(const gw_bake_options *options, const gw_error_estimate *error)
{
	return options->max_error > 0.0f && error->points > 0 &&
		   error->relative_rms + error->spread <= (double)options->max_error;
}

static uint32_t *rays_of(gw_bake_options *options)
{
	return options->method == GW_METHOD_RAYS ? &options->rays : &options->cones;
}

static uint32_t scaled(uint32_t count, double factor, uint32_t most)
{
	double wanted = ceil((double)count * factor);
	return wanted < (double)most ? (uint32_t)wanted : most;
}

static void grow_rays(gw_bake_options *next, double factor)
{
	uint32_t most = next->method == GW_METHOD_RAYS ? RAYS_MOST : 256;
	uint32_t *rays = rays_of(next);
	*rays = scaled(*rays, factor, most);
	next->light_samples = scaled(next->light_samples, factor, RAYS_MOST);
}

/* First the records move together, then the leaves get narrower; what there is no room for in the
 * one is left to the next round. */
static void grow_density(gw_bake_options *next, double factor)
{
	if (next->record_spacing > SPACING_LEAST)
		next->record_spacing = fmaxf(next->record_spacing / (float)factor, SPACING_LEAST);
	else if (next->depth == GW_DEPTH_AUTO && next->leaf_spacing > LEAF_LEAST)
		next->leaf_spacing = fmaxf(next->leaf_spacing / (float)factor, LEAF_LEAST);
}

static bool differs(const gw_bake_options *a, const gw_bake_options *b)
{
	return a->rays != b->rays || a->cones != b->cones || a->light_samples != b->light_samples ||
		   a->record_spacing < b->record_spacing || a->leaf_spacing < b->leaf_spacing;
}

/* How much larger the error of gathered light is than what is wanted beside what stays; twice,
 * where nothing is said. */
static double excess(const gw_refine_state *state)
{
	double wanted = (double)state->options->max_error;
	double stays = gw_error_floor(&state->error);
	double found = state->error.gathered + state->error.spread;
	if (stays < wanted)
		wanted = sqrt(wanted * wanted - stays * stays);
	return wanted > 0.0 ? fmax(found / wanted, 1.0) : 2.0;
}

/* Mean square error of gathered light that is wanted; 0 where none is, or what stays is more. */
static double wanted_square(const gw_refine_state *state)
{
	double wanted = (double)state->options->max_error;
	double stays = gw_error_floor(&state->error);
	return fmax(wanted * wanted - stays * stays, 0.0);
}

/* Whether rays are too few, whatever records there are. */
static bool is_noisy(const gw_refine_state *state)
{
	double noise = state->error.noise, wanted = wanted_square(state);
	return state->options->method == GW_METHOD_RAYS && wanted > 0.0 &&
		   noise * noise > NOISE_MOST * wanted;
}

/* How many times as many rays leave as little noise as what else there is allows. */
static double rays_against_noise(const gw_refine_state *state)
{
	double noise = state->error.noise * state->error.noise, wanted = wanted_square(state);
	double rest = fmax(state->error.gathered * state->error.gathered - noise, 0.0);
	return noise / fmax(AIM * AIM * wanted - rest, NOISE_AIM * wanted);
}

/* How many of the last rounds, one after the other, have not helped. */
static uint32_t rounds_in_vain(const gw_refine_state *state)
{
	uint32_t vain = 0;
	for (uint32_t i = state->round_count; state->round && i >= 2; i--, vain++) {
		const gw_error_estimate *e = &state->round[i - 1].error,
								*before = &state->round[i - 2].error;
		if (e->relative_rms + e->spread < HELPED * (before->relative_rms + before->spread))
			break;
	}
	return vain;
}

/* Whether more than the error that is asked for stays, whatever is paid. */
static bool is_out_of_reach(const gw_refine_state *state)
{
	double wanted = (double)state->options->max_error;
	return wanted > 0.0 && gw_error_floor(&state->error) >= wanted;
}

/* Whether more rounds would be in vain; who gives nothing but time wants it used. */
static bool would_be_in_vain(const gw_refine_state *state)
{
	return state->options->max_error > 0.0f && rounds_in_vain(state) >= VAIN_MOST;
}

/* Of the square error that records can lessen, what is to be left: noise stays, or half of what is
 * wanted is had from the rest. */
static double share_to_leave(const gw_refine_state *state)
{
	double factor = AIM / excess(state), share = factor * factor;
	double square = state->error.gathered * state->error.gathered;
	double noise = state->error.noise * state->error.noise;
	if (!(square > noise) || state->options->method != GW_METHOD_RAYS)
		return share;
	return fmax(share * square - noise, 0.5 * share * square) / (square - noise);
}

/* Whether the last round has added records to those of the one before. */
static bool has_added(const gw_refine_state *state)
{
	if (!state->round || state->round_count < 2)
		return false;
	const gw_round *last = &state->round[state->round_count - 1], *before = last - 1;
	return last->rays == before->rays && last->record_spacing == before->record_spacing &&
		   last->records > before->records;
}

/* What gw_refine_records answers where the rays are enough. */
static gw_refine_answer add_records(const gw_refine_state *state, gw_density_wish *wish,
									char why[96])
{
	if (state->crowded || !(state->options->record_spacing > 0.0f))
		return GW_REFINE_EXHAUSTED;
	/* As if all of the last round had been work that grows. */
	double most = state->options->method != GW_METHOD_RAYS ? GROWTH_OF_CONES
				  : has_added(state)                       ? GROWTH_AGAIN
														   : GROWTH_MOST;
	double work = fmin(state->seconds_left / fmax(state->round_seconds, 1e-3), most);
	if (work < WORK_LEAST)
		return GW_REFINE_NO_TIME;
	*wish = (gw_density_wish){ .share = fmin(share_to_leave(state), SHARE_MOST),
							   .least = state->least_spacing,
							   .most_growth = work };
	snprintf(why, 96, "records disagree most where more were put");
	return GW_REFINE_ROUND;
}

/* Whether gathered light is wrong by noise more than by all else; no rays are added to these. */
static bool is_all_noise(const gw_refine_state *state)
{
	double noise = state->error.noise, gathered = state->error.gathered;
	return state->options->method == GW_METHOD_RAYS && noise * noise > 0.5 * gathered * gathered;
}

/* Whether the last round has added records and gathered light is as wrong as before. */
static bool has_added_in_vain(const gw_refine_state *state)
{
	if (!has_added(state))
		return false;
	const gw_round *last = &state->round[state->round_count - 1], *before = last - 1;
	return last->error.gathered > HELPED * before->error.gathered;
}

/* Whether more rays would lessen a share of that which is worth them. */
static bool has_noise(const gw_refine_state *state)
{
	double noise = state->error.noise, gathered = state->error.gathered;
	return state->options->method == GW_METHOD_RAYS &&
		   noise * noise > SHARE_LEAST * gathered * gathered;
}

/* Whether records were so few `ago` rounds before the last one that what it said of them proves
 * nothing: they are too far apart to disagree wherever more are missing, and what is found between
 * them is as coarse. Of rooms, a corridor, a torus and a fence that begin with 40 to 70 records, up
 * to two rounds in a row leave the error as it is and the next ones a tenth of it; once records are
 * as many as those with which bakes begin, what follows such a round leaves .75 of it at the least.
 */
static bool were_few(const gw_refine_state *state, uint32_t ago)
{
	return state->round && state->round_count > ago &&
		   state->round[state->round_count - 1 - ago].records <
			   gw_bake_options_default().least_records;
}

gw_refine_answer gw_refine_gathered(const gw_refine_state *state, gw_density_wish *wish,
									char why[96])
{
	gw_bake_options options = *state->options;
	gw_refine_state aimed = *state;
	if (!(state->error.gathered > (double)options.gathered_error) ||
		(is_all_noise(state) && !were_few(state, 0)))
		return GW_REFINE_EXHAUSTED;
	if (has_added_in_vain(state) && !were_few(state, 1))
		return GW_REFINE_STALLED;
	/* An error of all light that leaves gathered light as much as it may have; the estimate's
	 * spread is not to ask for more records than the quality itself. */
	options.max_error = (float)hypot((double)options.gathered_error, gw_error_floor(&state->error));
	aimed.options = &options;
	aimed.error.spread = 0.0;
	aimed.round = NULL;
	gw_refine_answer answer = add_records(&aimed, wish, why);
	if (answer == GW_REFINE_ROUND)
		wish->most_growth = fmin(wish->most_growth, GROWTH_AGAIN);
	return answer;
}

/* Whether gathered light is more wrong than all that stays. */
static bool is_gathered_most(const gw_error_estimate *e)
{
	return e->gathered > gw_error_floor(e);
}

/* The error of gathered light that would hardly be missed beside what stays. */
static float hidden_error(const gw_error_estimate *e)
{
	return (float)(gw_error_floor(e) * sqrt(1.0 / (HELPED * HELPED) - 1.0));
}

/* Whether noise of the rays is, which no record lessens. */
static bool is_noise_most(const gw_error_estimate *e)
{
	return e->noise > gw_error_floor(e);
}

/* A target that is out of reach is not chased. While gathered light is more wrong than what stays,
 * it is aimed at what would not be missed beside that; else it becomes as right as the quality asks
 * for, by records no closer than those of the normal one. */
static gw_refine_answer go_as_far_as_quality(const gw_refine_state *state, gw_density_wish *wish,
											 char why[96])
{
	const gw_error_estimate *e = &state->error;
	gw_bake_options options = *state->options;
	gw_refine_state s = *state;
	float normal = fminf(options.record_spacing, gw_bake_options_default().record_spacing);
	bool gathered = is_gathered_most(e), enough = gw_error_floor(e) > HELPED * e->relative_rms;
	if (state->trial || enough ||
		(!gathered && has_added(state) &&
		 is_gathered_most(&state->round[state->round_count - 2].error)))
		return GW_REFINE_OUT_OF_REACH;
	if (is_noise_most(e))
		return GW_REFINE_EXHAUSTED;
	s.options = &options;
	if (gathered)
		options.gathered_error = hidden_error(e);
	else
		s.least_spacing = fmaxf(s.least_spacing, normal);
	gw_refine_answer answer = gw_refine_gathered(&s, wish, why);
	return answer == GW_REFINE_ROUND || answer == GW_REFINE_NO_TIME ? answer
																	: GW_REFINE_OUT_OF_REACH;
}

gw_refine_answer gw_refine_records(const gw_refine_state *state, gw_density_wish *wish,
								   char why[96])
{
	if (would_be_in_vain(state))
		return GW_REFINE_STALLED;
	if (is_out_of_reach(state))
		return go_as_far_as_quality(state, wish, why);
	bool full = state->options->rays >= RAYS_MOST;
	bool rays = is_noisy(state) || (has_added_in_vain(state) && has_noise(state));
	return rays && !full ? GW_REFINE_EXHAUSTED : add_records(state, wish, why);
}

/* Noise falls with the root of the rays, the rest about as fast as the records come closer. */
static growth wanted_growth(const gw_refine_state *state, char why[96])
{
	const gw_error_estimate *e = &state->error;
	double square = fmax(e->gathered * e->gathered, 1e-12);
	double noise = fmin(e->noise * e->noise / square, 1.0), factor = excess(state);
	bool vain = rounds_in_vain(state) > 0, added = has_added_in_vain(state);
	bool rays = vain || noise > SHARE_LEAST;
	bool density = !added && (vain || 1.0 - noise > SHARE_LEAST);
	snprintf(why, 96, "%.0f %% of the square error is noise of the rays%s", 100.0 * noise,
			 vain ? "; the last round did not help" : "");
	if (is_noisy(state) && !vain)
		return (growth){ .rays = fmin(fmax(rays_against_noise(state), 1.5), WORK_MOST),
						 .density = 1.0 };
	return (growth){ .rays = rays ? fmin(fmax(factor * factor, 2.0), 8.0) : 1.0,
					 .density = density ? fmin(fmax(factor, 1.4142135623730951), 2.0) : 1.0 };
}

static gw_bake_options grown(const gw_refine_state *state, growth by)
{
	gw_bake_options next = *state->options;
	if (by.rays > 1.0)
		grow_rays(&next, by.rays);
	if (by.density > 1.0)
		grow_density(&next, by.density);
	return next;
}

/* Where one setting is at its limit, the other one has to do. */
static growth possible_growth(const gw_refine_state *state, growth by)
{
	gw_bake_options next = grown(state, by);
	if (!differs(&next, state->options))
		by = (growth){ 2.0, 1.4142135623730951 };
	return by;
}

static double work_of(const gw_bake_options *next, const gw_bake_options *last)
{
	bool rays = next->method == GW_METHOD_RAYS;
	double samples = (double)(rays ? next->rays : next->cones) + next->light_samples;
	double before = (double)(rays ? last->rays : last->cones) + last->light_samples;
	double leaves = (double)last->leaf_spacing / (double)next->leaf_spacing;
	double spacing = last->record_spacing > 0.0f
						 ? (double)last->record_spacing / (double)next->record_spacing
						 : 1.0;
	return samples / before * spacing * spacing * leaves * leaves;
}

/* As if all of the last round had been work that grows: too long rather than too short. */
static double seconds_of(const gw_refine_state *state, const gw_bake_options *next)
{
	double leaves = (double)state->options->leaf_spacing / (double)next->leaf_spacing;
	double octree = leaves > 1.0 ? state->octree_seconds * leaves * leaves : 0.0;
	return state->round_seconds * work_of(next, state->options) + octree;
}

gw_refine_answer gw_refine_next(const gw_refine_state *state, gw_bake_options *next, char why[96])
{
	if (would_be_in_vain(state))
		return GW_REFINE_STALLED;
	if (is_out_of_reach(state) && !is_noise_most(&state->error))
		return GW_REFINE_OUT_OF_REACH;
	growth full = possible_growth(state, wanted_growth(state, why));
	gw_bake_options option = grown(state, full);
	if (!differs(&option, state->options))
		return GW_REFINE_EXHAUSTED;
	for (double part = 1.0; part > 0.1; part *= 0.75) {
		option = grown(state, (growth){ pow(full.rays, part), pow(full.density, part) });
		double work = work_of(&option, state->options);
		if (!differs(&option, state->options) || (part < 1.0 && work < WORK_LEAST))
			break;
		if (work > WORK_MOST || seconds_of(state, &option) > state->seconds_left)
			continue;
		*next = option;
		return GW_REFINE_ROUND;
	}
	return GW_REFINE_NO_TIME;
}
