/*
 * check_light.h - what sky and lamps send, reckoned on the processor for rays that check a bake.
 */
#ifndef CHECK_LIGHT_H
#define CHECK_LIGHT_H

#include "base/shader_math.h"
#include "light/gather_rays.h"
#include "light/transport_layout.h"

/* What comes from outside. */
typedef struct gw_check_sky {
	const float *radiance; /* 3, the same from everywhere */
	const gw_sky_map *map; /* or NULL: only where texel is there */
	const float *texel;    /* 4 * width * height of the map, or NULL */
} gw_check_sky;

/* Luminance of the radiance that comes from a direction: sky_map.glsl.
 *   towards   unit, to where it comes from */
double gw_check_sky_light(const gw_check_sky *sky, gw_vec3 towards);

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
double gw_check_lamp_light(const gw_light_push *lamp, const gw_check_place *place, gw_vec3 *towards,
						   float *distance);

#endif
