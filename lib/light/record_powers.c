/*
 * record_powers.c - see record_powers.h.
 */
#include "light/record_powers.h"

#include "light/cpu_loop.h"
#include "base/memory.h"
#include "base/shared_math.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

#define POWER_PARTS 8u /* sums of power that are made apart, so that threads do not matter */

typedef struct powers_job {
	gw_view albedo, centre, row, record, weight; /* of the facets */
	size_t facets, records;
	double *power; /* 3 a record and part */
	size_t part;   /* facets of a part */
} powers_job;

static void add_powers(void *user, size_t first, size_t last, uint32_t worker)
{
	const powers_job *job = user;
	const float *albedo = job->albedo.bytes, *centre = job->centre.bytes;
	double *power = job->power + 3 * job->records * (first / job->part);
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const size_t row = GW_WEIGHTS * (size_t)((const uint32_t *)job->row.bytes)[i];
		const uint32_t *record = (const uint32_t *)job->record.bytes + row;
		const float *weight = (const float *)job->weight.bytes + row;
		const double area = (double)centre[4 * i + 3] * (double)gw_facet_opacity(albedo[4 * i + 3]);
		const double share[3] = { GW_LUMINANCE_RED * area * (double)albedo[4 * i],
								  GW_LUMINANCE_GREEN * area * (double)albedo[4 * i + 1],
								  GW_LUMINANCE_BLUE * area * (double)albedo[4 * i + 2] };
		for (size_t k = 0; k < GW_WEIGHTS && record[k] != GW_NONE; k++)
			for (size_t c = 0; c < 3; c++)
				power[3 * (size_t)record[k] + c] += share[c] * (double)weight[k];
	}
}

static gw_status open_views(const gw_record_context *on, powers_job *job, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	uint64_t words = 4 * (uint64_t)GW_WEIGHTS * on->records->row_count;
	GW_TRY(gw_view_open(gpu, &on->octree->facet_albedo, 16 * job->facets, &job->albedo, error));
	GW_TRY(gw_view_open(gpu, &on->octree->facet_centre, 16 * job->facets, &job->centre, error));
	GW_TRY(gw_view_open(gpu, &on->records->facet_row, 4 * job->facets, &job->row, error));
	GW_TRY(gw_view_open(gpu, &on->records->facet_record, words, &job->record, error));
	return gw_view_open(gpu, &on->records->facet_weight, words, &job->weight, error);
}

static void close_views(powers_job *job)
{
	gw_view_close(&job->albedo);
	gw_view_close(&job->centre);
	gw_view_close(&job->row);
	gw_view_close(&job->record);
	gw_view_close(&job->weight);
}

static gw_status add_up(const gw_record_context *on, powers_job *job, float *power, gw_error *error)
{
	size_t values = 3 * job->records;
	GW_TRY(open_views(on, job, error));
	gw_cpu_loop(on->passes, GW_PASS_FACET_SHADE, job->facets, job->part, add_powers, job);
	for (size_t i = 0; i < values; i++) {
		double sum = 0.0;
		for (size_t part = 0; part < POWER_PARTS; part++)
			sum += job->power[part * values + i];
		power[i] = (float)(sum / (double)GW_PI);
	}
	return GW_OK;
}

gw_status gw_record_powers_find(const gw_record_context *on, gw_record_powers *powers,
								gw_error *error)
{
	size_t facets = on->octree->facet_count, values = 3 * (size_t)on->records->count;
	powers_job job = { .facets = facets,
					   .records = on->records->count,
					   .power = gw_allocate_zeros(values, POWER_PARTS * sizeof *job.power),
					   .part = facets / POWER_PARTS + 1 };
	powers->power = gw_allocate_array(values, sizeof *powers->power);
	gw_status status = job.power && powers->power
						   ? add_up(on, &job, powers->power, error)
						   : gw_fail(error, GW_ERROR_MEMORY,
									 "no memory for the power of %u records", on->records->count);
	close_views(&job);
	free(job.power);
	if (status != GW_OK)
		gw_record_powers_clear(powers);
	return status;
}

void gw_record_powers_clear(gw_record_powers *powers)
{
	free(powers->power);
	*powers = (gw_record_powers){ 0 };
}

gw_status gw_record_powers_measure(const gw_record_context *on, const gw_record_powers *powers,
								   gw_gathered_light *light, gw_error *error)
{
	gw_view view = { 0 };
	GW_TRY(gw_view_open(on->passes->gpu, &on->records->gathered, 16 * (uint64_t)on->records->count,
						&view, error));
	const float *gathered = view.bytes;
	double squares = 0.0;
	*light = (gw_gathered_light){ 0 };
	for (size_t i = 0; i < on->records->count; i++) {
		double part = 0.0;
		for (size_t c = 0; c < 3; c++) {
			double irradiance = fabs((double)gathered[4 * i + c]);
			part += (double)powers->power[3 * i + c] * irradiance;
			light->largest = fmax(light->largest, irradiance);
		}
		light->power += part;
		squares += part * part;
	}
	gw_view_close(&view);
	light->carriers = squares > 0.0 ? light->power * light->power / squares : 0.0;
	return GW_OK;
}
