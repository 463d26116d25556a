/*
 * light_given.c - see light_given.h.
 */
#include "light/light_given.h"

#include "base/luminance.h"
#include "light/shader_functions.h"

#include <math.h>

/* Does any surfel face the light, in its beam? */
static gw_light_fate fate_of(const gw_lit_cloud *cloud, const gw_lamp *lamp)
{
	const gw_surfels *s = cloud->surfels;
	const float *low = cloud->octree->cube_minimum;
	const gw_vec3 corner = { low[0], low[1], low[2] };
	for (size_t i = 0; i < s->count; i++) {
		gw_vec3 g = gw_times(gw_minus(gw_xyz(s->position + 3 * i), corner),
							 1.0f / cloud->octree->leaf_size);
		gw_vec3 own = gw_xyz((s->shading_normal ? s->shading_normal : s->normal) + 3 * i), towards;
		float distance;
		if (gw_lamp_received(lamp, g, own, &towards, &distance) > 0.0f ||
			(s->two_sided[i] &&
			 gw_lamp_received(lamp, g, gw_times(own, -1.0f), &towards, &distance) > 0.0f))
			return GW_LIGHT_HIDDEN;
	}
	return GW_LIGHT_AVERTED;
}

gw_status gw_given_book(const gw_lit_cloud *cloud, const gw_lamp *lamp, const gw_buffer *irradiance,
						gw_light_given *given, double *before, gw_error *error)
{
	size_t count = cloud->surfels->count;
	double flux = 0.0;
	gw_view light;
	GW_TRY(gw_view_open(cloud->passes->gpu, irradiance, 16 * (uint64_t)count, &light, error));
	for (size_t i = 0; i < count; i++)
		if (!cloud->asked || cloud->asked[i])
			flux +=
				(double)cloud->surfels->area[i] * gw_luminance((const float *)light.bytes + 4 * i);
	gw_view_close(&light);
	given->share = fmax(flux - *before, 0.0);
	given->fate = flux > *before || cloud->asked ? GW_LIGHT_SHINES : fate_of(cloud, lamp);
	*before = flux;
	return GW_OK;
}
