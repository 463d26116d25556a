/*
 * sky_map.h - the map of an environment light, ready to be looked up and sampled on the device.
 */
#ifndef SKY_MAP_H
#define SKY_MAP_H

#include "base/shader_math.h"
#include "device/gpu.h"

/* Larger maps are averaged down to this many texels, of which a full moon covers 9. */
#define GW_SKY_WIDTH 2048u
#define GW_SKY_HEIGHT 1024u

typedef struct gw_sky_map {
	uint32_t width, height; /* texels; 0: there is no map */
	float total;            /* luminance summed over solid angle */
	float turn;             /* of the centre, in turns clockwise from y */
	uint32_t y_up;
	uint64_t repaired; /* pixels that were negative or no number */
	uint64_t infinite; /* those that were infinite, or over 1e12 */
	gw_buffer texel;   /* R32G32B32A32_SFLOAT: radiance */
	gw_buffer alias;   /* R32G32_UINT: alias, probability (float bits); see alias_table.h */
} gw_sky_map;

/*
 * Makes the map of a light, which has one. A map without light leaves *map without texels (width
 * 0), but with its counts. GW_ERROR_MEMORY.
 */
gw_status gw_sky_map_make(gw_gpu *gpu, const gw_light *light, gw_sky_map *map, gw_error *error);
void gw_sky_map_destroy(gw_gpu *gpu, gw_sky_map *map);

/* What comes from outside, for the processor. */
typedef struct gw_sky_view {
	const float *radiance; /* 3, the same from everywhere */
	const gw_sky_map *map; /* or NULL: only where texel is there */
	const float *texel;    /* 4 * width * height of the map, or NULL */
} gw_sky_view;

/* The radiance that comes from a direction: sky_map.glsl.
 *   towards   unit, to where it comes from */
void gw_sky_radiance(const gw_sky_view *sky, gw_vec3 towards, float radiance[3]);

#endif
