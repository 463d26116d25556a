/*
 * light_given.h - how much of the light each lamp and sun gives, and why some give none.
 */
#ifndef LIGHT_GIVEN_H
#define LIGHT_GIVEN_H

#include "light/shader_functions.h"
#include "light/shadow_map.h"

/* Adds up what lamps give, one after the other. */
typedef struct gw_given_sum {
	float *host;   /* 4 a surfel */
	double before; /* of the lamps before */
} gw_given_sum;

/*
 * Books what came to the surfels since the last call for one light, one that reaches some of them
 * (lamp_reach.h) but for what hides it.
 *   irradiance   texel buffer R32G32B32A32_SFLOAT, surfel count, to which it was added
 *   given        receives in share its flux, luminance of E times area, in the cloud's units; and
 *                what became of it
 *   sum          zeroed before the first light; freed by gw_given_sum_clear
 */
gw_status gw_given_book(const gw_lit_cloud *cloud, const gw_lamp *lamp, const gw_buffer *irradiance,
						gw_light_given *given, gw_given_sum *sum, gw_error *error);
void gw_given_sum_clear(gw_given_sum *sum);

#endif
