/*
 * hit_facets.c - see hit_facets.h.
 */
#include "light/hit_facets.h"

#include "light/cpu_loop.h"
#include "base/memory.h"
#include "light/transport_layout.h"

#include <stdlib.h>

#define CHUNK 4096u /* facets that a thread takes at a time */

/* The facets that rays hit, in ascending order. */
static gw_status find_facets(const gw_octree *octree, const gw_records *records,
							 const gw_ray_gather *gather, gw_hit_facets *hits, gw_error *error)
{
	size_t facets = octree->facet_count;
	size_t rays = (size_t)gather->rays * records->count;
	const uint32_t *facet = gather->facet.mapped;
	bool *is_hit = gw_allocate_zeros(facets, sizeof *is_hit);
	for (size_t i = 0; i < rays && is_hit; i++)
		if (facet[i] != GW_NONE && !is_hit[facet[i]]) {
			is_hit[facet[i]] = true;
			hits->count++;
		}
	hits->facet = gw_allocate_array(hits->count, sizeof *hits->facet);
	bool complete = is_hit && hits->facet;
	for (size_t i = 0, n = 0; i < facets && complete; i++)
		if (is_hit[i])
			hits->facet[n++] = (uint32_t)i;
	free(is_hit);
	return complete ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu facets", facets);
}

gw_status gw_hit_facets_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 const gw_ray_gather *gather, gw_hit_facets *hits, gw_error *error)
{
	*hits = (gw_hit_facets){ 0 };
	gw_gpu_settle(passes->gpu); /* the facets are read where they lie */
	if (gw_gpu_stopped(passes->gpu))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped before the bounces");
	gw_status status = find_facets(octree, records, gather, hits, error);
	if (status != GW_OK)
		gw_hit_facets_clear(hits);
	return status;
}

void gw_hit_facets_clear(gw_hit_facets *hits)
{
	free(hits->facet);
	*hits = (gw_hit_facets){ 0 };
}

void gw_hit_facets_shade(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						 const gw_hit_facets *hits, gw_buffer *facet_radiance)
{
	const gw_binding bindings[] = {
		gw_whole(&octree->facet_albedo),  gw_whole(facet_radiance), /* no direct light */
		gw_whole(&records->facet_record), gw_whole(&records->facet_weight),
		gw_whole(&records->gathered),     gw_whole(facet_radiance),
		gw_whole(&records->facet_row)
	};
	const gw_kernel_run run = { .kernel = gw_kernel_facet_shade,
								.bindings = bindings,
								.push = &(gw_record_push){ 0 },
								.element = hits->facet };
	gw_gpu_settle(passes->gpu);
	gw_kernel_loop(passes, GW_PASS_FACET_SHADE, run, hits->count, CHUNK);
}
