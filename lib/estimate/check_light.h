/*
 * check_light.h - what sky and lamps send, reckoned on the processor for rays that check a bake.
 */
#ifndef CHECK_LIGHT_H
#define CHECK_LIGHT_H

#include "base/shader_math.h"
#include "light/gather_rays.h"
#include "light/shader_functions.h"

#include <math.h>

/* Luminance of what comes from outside from a direction. */
double gw_check_sky_light(const gw_sky_view *sky, gw_vec3 towards);

/* A place on a surface. */
typedef struct gw_check_place {
	gw_vec3 at;     /* leaf cells from the cube's corner */
	gw_vec3 normal; /* unit: the side that is lit */
} gw_check_place;

/*
 * Luminance of a lamp's irradiance at a place where nothing is in the way.
 *   towards    receives where the lamp is from there, unit
 *   distance   receives how far, leaf cells
 */
double gw_check_lamp_light(const gw_lamp *lamp, const gw_check_place *place, gw_vec3 *towards,
						   float *distance);

/* How often light arrives that is off by the same in each reflection, over how often it does at
 * first: 1 + kept + kept^2 and so on, of `limit` terms.
 *   kept    share that a reflection leaves, at least 0
 *   limit   bounces, or GW_BOUNCES_AUTO: without end */
static inline double gw_check_reflections(double kept, uint32_t limit)
{
	kept = fmin(kept, (double)GW_ALBEDO_MAX);
	return limit == GW_BOUNCES_AUTO ? 1.0 / (1.0 - kept) : (1.0 - pow(kept, limit)) / (1.0 - kept);
}

#endif
