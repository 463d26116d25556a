/*
 * check_light.c - see check_light.h.
 */
#include "estimate/check_light.h"

#include "base/luminance.h"
#include "light/shader_functions.h"

double gw_check_sky_light(const gw_sky_view *sky, gw_vec3 towards)
{
	float radiance[3];
	gw_sky_radiance(sky, towards, radiance);
	return gw_luminance(radiance);
}

double gw_check_lamp_light(const gw_lamp *lamp, const gw_check_place *place, gw_vec3 *towards,
						   float *distance)
{
	float light = gw_lamp_received(lamp, place->at, place->normal, towards, distance);
	return (double)(light * gw_luminance_of(gw_xyz(&lamp->push.intensity.x)));
}
