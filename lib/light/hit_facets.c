/*
 * hit_facets.c - see hit_facets.h.
 */
#include "light/hit_facets.h"

#include "light/cpu_loop.h"
#include "base/memory.h"
#include "base/shared_math.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

#define CHUNK 4096u    /* facets that a thread takes at a time */
#define POWER_PARTS 8u /* sums of power that are made apart, so that threads do not matter */

typedef struct powers {
	const float *albedo, *centre, *weight;
	const uint32_t *record;
	size_t records;
	double *power; /* 3 a record and part */
	size_t part;   /* slots of a part */
} powers;

static void add_powers(void *user, size_t first, size_t last, uint32_t worker)
{
	const powers *job = user;
	const float *albedo = job->albedo;
	double *power = job->power + 3 * job->records * (first / job->part);
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const uint32_t *record = job->record + GW_WEIGHTS * i;
		const float *weight = job->weight + GW_WEIGHTS * i;
		const double area =
			(double)job->centre[4 * i + 3] * (double)gw_facet_opacity(albedo[4 * i + 3]);
		const double share[3] = { GW_LUMINANCE_RED * area * (double)albedo[4 * i],
								  GW_LUMINANCE_GREEN * area * (double)albedo[4 * i + 1],
								  GW_LUMINANCE_BLUE * area * (double)albedo[4 * i + 2] };
		for (size_t k = 0; k < GW_WEIGHTS && record[k] != GW_NONE; k++)
			for (size_t c = 0; c < 3; c++)
				power[3 * (size_t)record[k] + c] += share[c] * (double)weight[k];
	}
}

static gw_status find_powers(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 gw_hit_facets *hits, gw_error *error)
{
	size_t slots = 2 * (size_t)octree->leaf_count, values = 3 * (size_t)records->count;
	powers job = { .albedo = octree->facet_albedo.mapped,
				   .centre = octree->facet_centre.mapped,
				   .weight = records->facet_weight.mapped,
				   .record = records->facet_record.mapped,
				   .records = records->count,
				   .power = gw_allocate_zeros(values, POWER_PARTS * sizeof *job.power),
				   .part = slots / POWER_PARTS + 1 };
	hits->power = gw_allocate_array(values, sizeof *hits->power);
	gw_status status = GW_OK;
	if (!job.power || !hits->power)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", records->count);
	if (status == GW_OK)
		gw_cpu_loop(passes, GW_PASS_FACET_SHADE, slots, job.part, add_powers, &job);
	for (size_t i = 0; i < values && status == GW_OK; i++) {
		double sum = 0.0;
		for (size_t part = 0; part < POWER_PARTS; part++)
			sum += job.power[part * values + i];
		hits->power[i] = (float)(sum / (double)GW_PI);
	}
	free(job.power);
	return status;
}

/* The slots that rays hit, in ascending order. */
static gw_status find_slots(const gw_octree *octree, const gw_records *records,
							const gw_ray_gather *gather, gw_hit_facets *hits, gw_error *error)
{
	size_t slots = 2 * (size_t)octree->leaf_count;
	size_t rays = (size_t)gather->rays * records->count;
	const uint32_t *facet = gather->facet.mapped;
	bool *is_hit = gw_allocate_zeros(slots, sizeof *is_hit);
	for (size_t i = 0; i < rays && is_hit; i++)
		if (facet[i] != GW_NONE && !is_hit[facet[i]]) {
			is_hit[facet[i]] = true;
			hits->count++;
		}
	hits->slot = gw_allocate_array(hits->count, sizeof *hits->slot);
	bool complete = is_hit && hits->slot;
	for (size_t i = 0, n = 0; i < slots && complete; i++)
		if (is_hit[i])
			hits->slot[n++] = (uint32_t)i;
	free(is_hit);
	return complete ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu facets", slots);
}

gw_status gw_hit_facets_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 const gw_ray_gather *gather, gw_hit_facets *hits, gw_error *error)
{
	*hits = (gw_hit_facets){ 0 };
	if (gw_gpu_stopped(passes->gpu))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped before the bounces");
	gw_status status = find_slots(octree, records, gather, hits, error);
	if (status == GW_OK)
		status = find_powers(passes, octree, records, hits, error);
	if (status != GW_OK)
		gw_hit_facets_clear(hits);
	return status;
}

void gw_hit_facets_clear(gw_hit_facets *hits)
{
	free(hits->slot);
	free(hits->power);
	*hits = (gw_hit_facets){ 0 };
}

void gw_hit_facets_shade(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						 const gw_hit_facets *hits, gw_buffer *facet_radiance)
{
	const gw_binding bindings[] = {
		gw_whole(&octree->facet_albedo),  gw_whole(facet_radiance), /* no direct light */
		gw_whole(&records->facet_record), gw_whole(&records->facet_weight),
		gw_whole(&records->gathered),     gw_whole(facet_radiance)
	};
	const gw_kernel_run run = { .kernel = gw_kernel_facet_shade,
								.bindings = bindings,
								.push = &(gw_record_push){ 0 },
								.element = hits->slot };
	gw_kernel_loop(passes, GW_PASS_FACET_SHADE, run, hits->count, CHUNK);
}

double gw_hit_facets_power(const gw_records *records, const gw_hit_facets *hits)
{
	const float *gathered = records->gathered.mapped;
	double power = 0.0;
	for (size_t i = 0; i < records->count; i++)
		for (size_t c = 0; c < 3; c++)
			power += (double)hits->power[3 * i + c] * fabs((double)gathered[4 * i + c]);
	return power;
}
