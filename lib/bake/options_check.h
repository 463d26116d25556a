/*
 * options_check.h - whether a bake's options make sense, and what follows from them.
 */
#ifndef OPTIONS_CHECK_H
#define OPTIONS_CHECK_H

#include "glowworm_probes.h"

/* Cells along the longest side where their number is left to the method. Light that goes from cell
 * to cell spreads more, and takes longer, the more there are. */
#define GW_VOLUME_CELLS 64u
#define GW_LPV_CELLS 16u

/* GW_ERROR_USAGE when options or lights make no sense, GW_ERROR_DATA when there are no points. */
gw_status gw_options_check(const gw_bake_options *options, const gw_scene_description *scene,
						   gw_error *error);

/* The options with what follows from effects that they forbid: no shadows, one reflection... */
gw_bake_options gw_options_effective(const gw_bake_options *options);

/* Whether the options ask to refine until an error or a time is reached. */
bool gw_options_refine(const gw_bake_options *options);

/* Share of the light that GW_BOUNCES_AUTO leaves out: tolerance, but at most a quarter of
 * max_error, which it is a part of. */
float gw_options_bounce_tolerance(const gw_bake_options *options);

/* Whether they ask which directions are open, and for anything that record_fields.h collects. */
bool gw_options_occlusion(const gw_bake_options *options);
bool gw_options_record_fields(const gw_bake_options *options);

/* Whether records may be few at first: those that are missing are found by an estimate of the
 * error, or none are to be added. */
bool gw_options_few_records(const gw_bake_options *options);

/* Whether an effect is forbidden. */
static inline bool gw_options_forbid(const gw_bake_options *options, gw_effect_kind effect)
{
	return options->effects_forbidden & 1u << effect;
}

/* GW_ERROR_USAGE when options of probes make no sense. */
gw_status gw_probes_options_check(const gw_probes_options *options, gw_error *error);

#endif
