/*
 * record_fields.c - see record_fields.h.
 */
#include "record_fields.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>

static double luminance(const float *c)
{
	return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
}

static float *allocate(size_t count, gw_error *error)
{
	float *values = gw_allocate_zeros(count, sizeof *values);
	if (!values)
		gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu numbers", count);
	return values;
}

/* One number a surfel to all points; 0 for points that are left out. */
static gw_status to_points(const gw_surfels *surfels, const float *values, float **points,
						   gw_error *error)
{
	*points = allocate(surfels->point_count, error);
	if (!*points)
		return GW_ERROR_MEMORY;
	for (size_t i = 0; i < surfels->point_count; i++)
		if (surfels->surfel_of_point[i] != UINT32_MAX)
			(*points)[i] = values[surfels->surfel_of_point[i]];
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- openness */

/* Share of each record's rays that go farther than the distance; negative distances passed the back
 * of a surface. */
static gw_status open_records(const gw_solver *s, float *open, gw_error *error)
{
	uint64_t rays = s->rays.rays, hits = rays * s->records.count;
	float wanted = s->options.occlusion_distance / s->octree.leaf_size;
	float limit = s->options.occlusion_distance > 0.0f ? fminf(wanted, 1e9f) : 1e9f;
	float *distance = allocate((size_t)hits, error);
	if (!distance)
		return GW_ERROR_MEMORY;
	gw_status status = gw_buffer_download(s->gpu, (gw_buffer *)(uintptr_t)&s->rays.distance, 0,
										  distance, 4 * hits, error);
	for (size_t i = 0; i < s->records.count && status == GW_OK; i++) {
		uint32_t passed = 0;
		for (size_t k = 0; k < rays; k++)
			passed += fabsf(distance[i * rays + k]) >= limit;
		open[4 * i] = (float)passed / (float)rays;
	}
	free(distance);
	return status;
}

static gw_status find_openness(const gw_solver *s, float **points, gw_error *error)
{
	const gw_read_back *rows = &s->read_back;
	float *records = allocate(4 * (size_t)s->records.count, error);
	float *surfels = allocate(4 * s->surfels.count, error);
	gw_status status = records && surfels ? open_records(s, records, error) : GW_ERROR_MEMORY;
	if (status == GW_OK) {
		gw_read_back_apply(rows, records, s->options.threads, surfels);
		for (size_t i = 0; i < s->surfels.count; i++)
			surfels[i] = rows->first[i] == rows->first[i + 1] ? 1.0f : surfels[4 * i];
		status = to_points(&s->surfels, surfels, points, error);
	}
	free(records);
	free(surfels);
	return status;
}

/* ------------------------------------------------------------------------------ disagreement */

/* Standard error of the mean of the records that light surfel i, as luminance of irradiance. */
static double disagreement(const gw_read_back *rows, const double *records, size_t i)
{
	double mean = 0.0, squares = 0.0, spread = 0.0;
	for (uint32_t e = rows->first[i]; e < rows->first[i + 1]; e++) {
		double weight = (double)rows->weight[e];
		mean += weight * records[rows->record[e]];
		squares += weight * weight;
	}
	for (uint32_t e = rows->first[i]; e < rows->first[i + 1]; e++) {
		double off = records[rows->record[e]] - mean;
		spread += (double)rows->weight[e] * off * off;
	}
	return squares > 0.999 ? fabs(mean) : sqrt(spread / (1.0 - squares) * squares);
}

/* Luminance of all that the records gathered. */
static gw_status gathered(const gw_solver *s, double *sum, gw_error *error)
{
	const gw_buffer *parts[2] = { &s->records.first, &s->records.indirect };
	float *values = allocate(4 * (size_t)s->records.count, error);
	gw_status status = values ? GW_OK : GW_ERROR_MEMORY;
	for (int k = 0; k < 2 && status == GW_OK; k++) {
		status = gw_buffer_download(s->gpu, (gw_buffer *)(uintptr_t)parts[k], 0, values,
									16 * (uint64_t)s->records.count, error);
		for (size_t i = 0; i < s->records.count && status == GW_OK; i++)
			sum[i] += luminance(values + 4 * i);
	}
	free(values);
	return status;
}

static gw_status find_errors(const gw_relight *relight, float **points, gw_error *error)
{
	const gw_solver *s = relight->solver;
	float *surfels = allocate(s->surfels.count, error);
	double *records = gw_allocate_zeros(s->records.count, sizeof *records);
	gw_status status = GW_OK;
	if (!surfels || !records)
		status = gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u records", s->records.count);
	if (status == GW_OK && relight->plan.records)
		status = gathered(s, records, error);
	for (size_t i = 0; i < s->surfels.count && status == GW_OK && relight->plan.records; i++)
		surfels[i] = (float)(disagreement(&s->read_back, records, i) *
							 luminance(s->surfels.albedo + 3 * i) * 0.31830988618379067);
	if (status == GW_OK)
		status = to_points(&s->surfels, surfels, points, error);
	free(surfels);
	free(records);
	return status;
}

gw_status gw_record_fields_collect(const gw_relight *relight, gw_bake_result *result,
								   gw_error *error)
{
	const gw_bake_options *o = &relight->solver->options;
	gw_status status = GW_OK;
	if (o->occlusion)
		status = find_openness(relight->solver, &result->openness, error);
	if (status == GW_OK && o->errors)
		status = find_errors(relight, &result->error, error);
	return status;
}
