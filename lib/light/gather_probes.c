/*
 * gather_probes.c - see gather_probes.h.
 */
#include "light/gather_probes.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "light/probe_look.h"
#include "light/shader_functions.h"

#include <stdlib.h>

#define CHUNK 64u /* records that a thread takes at a time */

/* How far a ray goes that meets nothing, as in octree/ray.glsl. */
#define FAR_AWAY 1e9f

/* Rays under way. */
typedef struct following {
	const gw_probe_maps *maps;
	gw_view position, normal; /* of the records */
	uint32_t rays, seed;
	uint32_t *facet; /* rays a record */
	float *distance;
} following;

static void follow(void *user, size_t first, size_t last, uint32_t worker)
{
	const following *f = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const gw_vec3 g = gw_xyz((const float *)f->position.bytes + 4 * i);
		const gw_vec3 normal = gw_xyz((const float *)f->normal.bytes + 4 * i);
		const double from[3] = { (double)g.x, (double)g.y, (double)g.z };
		for (uint32_t k = 0; k < f->rays; k++) {
			const gw_vec3 way = gw_record_ray(g, normal, k, f->rays, f->seed);
			const size_t at = f->rays * i + k;
			gw_probe_texel seen;
			gw_probes_find(f->maps->probes, from, (const float[3]){ way.x, way.y, way.z }, true,
						   &seen);
			f->facet[at] = f->maps->facet[seen.texel];
			f->distance[at] = f->facet[at] == GW_NONE ? FAR_AWAY : (float)seen.distance;
		}
	}
}

static gw_status follow_all(const gw_record_context *on, following *f, gw_ray_gather *gather,
							gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	const uint64_t records = on->records->count, bytes = 4 * records * f->rays;
	f->facet = gw_allocate_array(records, f->rays * sizeof *f->facet);
	f->distance = gw_allocate_array(records, f->rays * sizeof *f->distance);
	if (!f->facet || !f->distance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %llu rays",
					   (unsigned long long)(records * f->rays));
	GW_TRY(gw_view_open(gpu, &on->records->position, 16 * records, &f->position, error));
	GW_TRY(gw_view_open(gpu, &on->records->normal, 16 * records, &f->normal, error));
	gw_parallel_for(on->passes->threads, records, CHUNK, follow, f);
	GW_TRY(gw_buffer_upload(gpu, &gather->facet, 0, f->facet, bytes, error));
	return gw_buffer_upload(gpu, &gather->distance, 0, f->distance, bytes, error);
}

gw_status gw_probe_gather_trace(const gw_record_context *on, const gw_probe_maps *maps,
								uint32_t rays, uint32_t seed, gw_ray_gather *gather,
								gw_error *error)
{
	following f = { .maps = maps, .rays = rays, .seed = seed };
	GW_TRY(gw_ray_gather_create(on->passes->gpu, on->records, rays, seed, gather, error));
	gw_status status = follow_all(on, &f, gather, error);
	gw_view_close(&f.position);
	gw_view_close(&f.normal);
	free(f.facet);
	free(f.distance);
	if (status != GW_OK)
		gw_ray_gather_destroy(on->passes->gpu, gather);
	return status;
}

void gw_probe_maps_clear(gw_probe_maps *maps)
{
	gw_probes_destroy(&maps->probes);
	free(maps->facet);
	maps->facet = NULL;
}
