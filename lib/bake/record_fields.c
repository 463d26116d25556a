/*
 * record_fields.c - see record_fields.h.
 */
#include "bake/record_fields.h"

#include "base/luminance.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

static float *allocate(size_t count, gw_error *error)
{
	float *values = gw_allocate_zeros(count, sizeof *values);
	if (!values)
		gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu numbers", count);
	return values;
}

/* One number a surfel to all points; 0 for points that are left out. */
static gw_status to_points(const gw_lighting *lighting, const float *values, float **points,
						   gw_error *error)
{
	const gw_surfels *surfels = &lighting->scene->surfels;
	*points = allocate(surfels->point_count, error);
	if (!*points)
		return GW_ERROR_MEMORY;
	for (size_t i = 0; i < surfels->point_count; i++)
		if (surfels->surfel_of_point[i] != UINT32_MAX)
			(*points)[i] = values[gw_lighting_shown(lighting, surfels->surfel_of_point[i])];
	for (size_t j = 0; j < surfels->stray_count; j++)
		if (surfels->stray[j].surfel != UINT32_MAX)
			(*points)[surfels->stray[j].point] =
				values[gw_lighting_shown(lighting, surfels->stray[j].surfel)];
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- ambient
 * occlusion */

/* Share of each record's rays that go farther than the distance; negative distances passed the back
 * of a surface. */
static gw_status open_records(const gw_scene *s, float *open, gw_error *error)
{
	uint64_t rays = s->rays.rays, hits = rays * s->records.count;
	float wanted = s->options.ambient_occlusion_distance / s->octree.leaf_size;
	float limit = s->options.ambient_occlusion_distance > 0.0f ? fminf(wanted, 1e9f) : 1e9f;
	float *distance = allocate((size_t)hits, error);
	if (!distance)
		return GW_ERROR_MEMORY;
	gw_status status = gw_buffer_download(s->gpu, &s->rays.distance, 0, distance, 4 * hits, error);
	for (size_t i = 0; i < s->records.count && status == GW_OK; i++) {
		uint32_t passed = 0;
		for (size_t k = 0; k < rays; k++)
			passed += fabsf(distance[i * rays + k]) >= limit;
		open[4 * i] = (float)passed / (float)rays;
	}
	free(distance);
	return status;
}

static gw_status find_ambient_occlusion(const gw_lighting *lighting, float **points,
										gw_error *error)
{
	const gw_scene *s = lighting->scene;
	const gw_read_back *rows = &s->read_back;
	float *records = allocate(4 * (size_t)s->records.count, error);
	float *surfels = allocate(4 * s->surfels.count, error);
	gw_status status = records && surfels ? open_records(s, records, error) : GW_ERROR_MEMORY;
	if (status == GW_OK) {
		gw_read_back_apply(rows, records, s->options.threads, surfels);
		for (size_t i = 0; i < s->surfels.count; i++)
			surfels[i] = rows->first[i] == rows->first[i + 1] ? 1.0f : surfels[4 * i];
		status = to_points(lighting, surfels, points, error);
	}
	free(records);
	free(surfels);
	return status;
}

/* ------------------------------------------------------------------------------ disagreement */

static gw_status find_errors(const gw_lighting *lighting, float **points, gw_error *error)
{
	const gw_scene *s = lighting->scene;
	float *surfels = allocate(s->surfels.count, error);
	double *records = gw_allocate_zeros(s->records.count, sizeof *records);
	gw_status status = GW_OK;
	if (!surfels || !records)
		status = gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u records", s->records.count);
	if (status == GW_OK && lighting->plan.records)
		status = gw_records_light(s->gpu, &s->records, records, error);
	for (size_t i = 0; i < s->surfels.count && status == GW_OK && lighting->plan.records; i++)
		surfels[i] = (float)(sqrt(gw_read_back_variance(&s->read_back, records, i, 1.0)) *
							 gw_luminance(s->surfels.albedo + 3 * i) * 0.31830988618379067);
	if (status == GW_OK)
		status = to_points(lighting, surfels, points, error);
	free(surfels);
	free(records);
	return status;
}

/* ----------------------------------------------------------------------------------- gaps */

static gw_status find_unknown(const gw_lighting *lighting, float **points, gw_error *error)
{
	const gw_scene *s = lighting->scene;
	float *records = allocate(4 * (size_t)s->records.count, error);
	float *surfels = allocate(4 * s->surfels.count, error);
	gw_status status = records && surfels ? GW_OK : GW_ERROR_MEMORY;
	for (size_t i = 0; i < s->records.count && status == GW_OK && lighting->gap; i++)
		records[4 * i] = lighting->gap[i].share;
	if (status == GW_OK && lighting->gap)
		gw_read_back_apply(&s->read_back, records, s->options.threads, surfels);
	for (size_t i = 0; i < s->surfels.count && status == GW_OK; i++)
		surfels[i] = surfels[4 * i];
	if (status == GW_OK)
		status = to_points(lighting, surfels, points, error);
	free(records);
	free(surfels);
	return status;
}

gw_status gw_record_fields_collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error)
{
	const gw_bake_options *o = &lighting->scene->options;
	GW_TRY(gw_lighting_choose_sides(lighting, error));
	if (o->ambient_occlusion)
		GW_TRY(find_ambient_occlusion(lighting, &result->ambient_occlusion, error));
	if (o->unknown)
		GW_TRY(find_unknown(lighting, &result->unknown, error));
	if (o->errors)
		GW_TRY(find_errors(lighting, &result->error, error));
	return GW_OK;
}
