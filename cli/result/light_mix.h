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

/* A mix: of a cloud, or of its parts one after the other. */
typedef struct light_mix {
	const settings_gain *gain; /* gain_count of them; two for one lamp multiply */
	size_t gain_count;
	size_t removed;      /* columns of the last part that were left out */
	uint64_t points;     /* of all parts so far */
	bool adds_up;        /* is known, so that it is not looked at again */
	double own, squares; /* sums over these: radiance that came in, and by how much the sum of the
							lamps is off it, both squared */
	uint32_t bits;       /* that are set in some of these values, as floats */
} light_mix;

/*
 * Multiplies the columns of the lamps by their gains (1 where none is given) and replaces
 * scalar_radiance_* and quality by their sum. Columns that it would make wrong (those of direct
 * and indirect light, irradiance, illuminance, error) are removed.
 *
 *   mix       with its gains set, and zeros before the first part
 *   cloud     changed; on failure half of it may be
 *   radiance  receives 3 * count values, to be freed by the caller; NULL on failure
 *   error     GW_ERROR_USAGE for a lamp that the cloud does not have, GW_ERROR_DATA when it has
 *             none, or when they are not finite
 */
gw_status light_mix_apply(light_mix *mix, scan *cloud, float **radiance, gw_error *error);

/* After the last part: GW_ERROR_DATA when the lamps as they came in do not make the radiance that
 * came in, if there is one. */
gw_status light_mix_check(const light_mix *mix, gw_error *error);

#endif
