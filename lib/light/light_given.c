/*
 * light_given.c - see light_given.h.
 */
#include "light/light_given.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "light/shader_functions.h"

#include <math.h>
#include <stdlib.h>

/* Does a surfel face the light, as light_irradiance.comp has it, and stand in its beam? */
static bool faces(const gw_lit_cloud *cloud, const gw_light_push *push, size_t i)
{
	const gw_surfels *s = cloud->surfels;
	const float *own = (s->shading_normal ? s->shading_normal : s->normal) + 3 * i;
	const float *low = cloud->octree->cube_minimum;
	gw_vec3 g = gw_times(gw_minus(gw_xyz(s->position + 3 * i), (gw_vec3){ low[0], low[1], low[2] }),
						 1.0f / cloud->octree->leaf_size);
	gw_vec3 towards;
	float distance;
	if (!(gw_lamp_share(push, g, &towards, &distance) > 0.0f))
		return false;
	float cosine = gw_dot(gw_xyz(own), towards);
	return (s->two_sided[i] ? fabsf(cosine) : cosine) > 0.0f;
}

static gw_light_fate fate_of(const gw_lit_cloud *cloud, const gw_light_push *push)
{
	for (size_t i = 0; i < cloud->surfels->count; i++)
		if (faces(cloud, push, i))
			return GW_LIGHT_HIDDEN;
	return GW_LIGHT_AVERTED;
}

gw_status gw_given_book(const gw_lit_cloud *cloud, const gw_light_push *push,
						const gw_buffer *irradiance, gw_light_given *given, gw_given_sum *sum,
						gw_error *error)
{
	size_t count = cloud->surfels->count;
	double flux = 0.0;
	if (!sum->host)
		sum->host = gw_allocate_array(count, 4 * sizeof *sum->host);
	if (!sum->host)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for the light of %zu surfels",
					   count);
	GW_TRY(gw_buffer_download(cloud->passes->gpu, irradiance, 0, sum->host, 16 * (uint64_t)count,
							  error));
	for (size_t i = 0; i < count; i++)
		flux += (double)cloud->surfels->area[i] * gw_luminance(sum->host + 4 * i);
	given->share = fmax(flux - sum->before, 0.0);
	given->fate = flux > sum->before ? GW_LIGHT_SHINES : fate_of(cloud, push);
	sum->before = flux;
	return GW_OK;
}

void gw_given_sum_clear(gw_given_sum *sum)
{
	free(sum->host);
	*sum = (gw_given_sum){ .host = NULL };
}
