/*
 * check_light.c - see check_light.h.
 */
#include "estimate/check_light.h"

#include "base/luminance.h"
#include "base/shared_math.h"
#include "light/shader_functions.h"

#include <math.h>

double gw_check_sky_light(const gw_check_sky *sky, gw_vec3 d)
{
	const gw_sky_map *m = sky->map;
	double light = gw_luminance(sky->radiance);
	if (!sky->texel)
		return light;
	float height = m->y_up ? d.y : d.z, north = m->y_up ? -d.z : d.y;
	float u = atan2f(d.x, north) / (2.0f * GW_PI) + 0.5f - m->turn;
	float v = acosf(gw_smaller(gw_larger(height, -1.0f), 1.0f)) / GW_PI;
	uint32_t column = (uint32_t)((u - floorf(u)) * (float)m->width);
	uint32_t row = (uint32_t)(v * (float)m->height);
	column = column < m->width ? column : m->width - 1;
	row = row < m->height ? row : m->height - 1;
	return light + gw_luminance(sky->texel + 4 * ((size_t)row * m->width + column));
}

double gw_check_lamp_light(const gw_light_push *lamp, const gw_check_place *place, gw_vec3 *towards,
						   float *distance)
{
	float share = gw_lamp_share(lamp, place->at, towards, distance);
	float light = share * gw_larger(0.0f, gw_dot(place->normal, *towards));
	if (lamp->type != GW_PUSH_SUN)
		light /= *distance * *distance;
	return (double)(light * gw_luminance_of(gw_xyz(&lamp->intensity.x)));
}
