/*
 * light_mix.h - radiance as the sum of what each lamp gives, so that lamps can be dimmed after a
 * bake.
 *
 * A cloud that was baked so has three columns for each lamp, scalar_light_NAME_r, _g and _b: the
 * radiance that this lamp alone gives, all reflections included. What no lamp gives (emission of
 * points, sky without a name) is the lamp called rest. Light adds up: the sum of all lamps is the
 * radiance.
 */
#ifndef LIGHT_MIX_H
#define LIGHT_MIX_H

#include "points/scan.h"
#include "options/settings.h"

/*
 * Multiplies the columns of the lamps by their gains (1 where none is given) and replaces
 * scalar_radiance_* and quality by their sum. Columns that it would make wrong (those of direct
 * and indirect light, irradiance, illuminance, error) are removed.
 *
 *   cloud     changed; on failure half of it may be
 *   gain      gain_count of them; two for one lamp multiply
 *   radiance  receives 3 * count values, to be freed by the caller; NULL on failure
 *   removed   receives how many columns were removed
 *   error     GW_ERROR_USAGE for a lamp that the cloud does not have, GW_ERROR_DATA when it has
 *             none, or when they are not finite or do not add up to its radiance
 */
gw_status light_mix_apply(scan *cloud, const settings_gain *gain, size_t gain_count,
						  float **radiance, size_t *removed, gw_error *error);

#endif
