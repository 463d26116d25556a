/*
 * light_given.h - how much of the light each lamp and sun gives, and why some give none.
 */
#ifndef LIGHT_GIVEN_H
#define LIGHT_GIVEN_H

#include "light/shader_functions.h"
#include "light/shadow_map.h"

/*
 * Books what came to the surfels since the last call for one light, one that reaches some of them
 * (lamp_reach.h) but for what hides it.
 *   irradiance   texel buffer R32G32B32A32_SFLOAT, surfel count, to which it was added
 *   given        receives in share its flux, luminance of E times area, in the cloud's units; and
 *                what became of it
 *   before       0 before the first light; what those before have given
 */
gw_status gw_given_book(const gw_lit_cloud *cloud, const gw_lamp *lamp, const gw_buffer *irradiance,
						gw_light_given *given, double *before, gw_error *error);

#endif
