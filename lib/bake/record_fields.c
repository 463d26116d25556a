/*
 * record_fields.c - see record_fields.h.
 */
#include "bake/record_fields.h"
#include "bake/options_check.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "light/shader_functions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static float *allocate(size_t count, gw_error *error)
{
	float *values = gw_allocate_zeros(count, sizeof *values);
	if (!values)
		gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu numbers", count);
	return values;
}

/* The numbers of that side of a surfel which is shown, if there is one. */
static void copy_shown(const gw_lighting *lighting, size_t width, const float *values,
					   uint32_t surfel, float *point)
{
	uint32_t shown = gw_lighting_shown(lighting, surfel);
	if (shown != UINT32_MAX)
		memcpy(point, values + width * shown, width * sizeof *values);
}

/* `width` numbers a surfel to all points; 0 for points that are left out. */
static gw_status to_points(const gw_lighting *lighting, size_t width, const float *values,
						   float **points, gw_error *error)
{
	const gw_surfels *surfels = &lighting->scene->surfels;
	*points = allocate(width * surfels->point_count, error);
	if (!*points)
		return GW_ERROR_MEMORY;
	for (size_t i = 0; i < surfels->point_count; i++)
		copy_shown(lighting, width, values, surfels->surfel_of_point[i], *points + width * i);
	for (size_t j = 0; j < surfels->stray_count; j++)
		copy_shown(lighting, width, values, surfels->stray[j].surfel,
				   *points + width * surfels->stray[j].point);
	return GW_OK;
}

/* -------------------------------------------------------------- ambient light and bent normals */

/* Rays of the records: how far they go, and the places that they start from. */
typedef struct open_rays {
	const gw_lighting *lighting;
	const gw_scene *scene;               /* the lighting's */
	float *distance, *position, *normal; /* the last two NULL unless directions are wanted */
} open_rays;

static void clear_rays(open_rays *r)
{
	free(r->distance);
	free(r->position);
	free(r->normal);
}

/* 4 floats a record, on the CPU. */
static gw_status fetch(const gw_scene *s, const gw_buffer *buffer, float **values, gw_error *error)
{
	*values = allocate(4 * (size_t)s->records.count, error);
	return *values ? gw_buffer_download(s->gpu, buffer, 0, *values, 16 * (uint64_t)s->records.count,
										error)
				   : GW_ERROR_MEMORY;
}

static gw_status fetch_rays(open_rays *r, bool directions, gw_error *error)
{
	const gw_scene *s = r->scene;
	uint64_t hits = (uint64_t)s->rays.rays * s->records.count;
	r->distance = allocate((size_t)hits, error);
	if (!r->distance)
		return GW_ERROR_MEMORY;
	GW_TRY(gw_buffer_download(s->gpu, &s->rays.distance, 0, r->distance, 4 * hits, error));
	if (!directions)
		return GW_OK;
	GW_TRY(fetch(s, &s->records.position, &r->position, error));
	return fetch(s, &s->records.normal, &r->normal, error);
}

/* How far rays have to go to be open, leaf cells. */
static float open_distance(const gw_scene *s)
{
	float wanted = s->options.ambient_occlusion_distance / s->octree.leaf_size;
	return s->options.ambient_occlusion_distance > 0.0f ? fminf(wanted, 1e9f) : 1e9f;
}

/* Is a ray of a record open? Negative distances passed the back of a surface. */
static bool is_open(const open_rays *r, size_t record, uint32_t k)
{
	return fabsf(r->distance[record * r->scene->rays.rays + k]) >= open_distance(r->scene);
}

/* Share of each record's rays that are open. */
static void find_shares(const open_rays *r, float *records)
{
	uint32_t rays = r->scene->rays.rays;
	for (size_t i = 0; i < r->scene->records.count; i++) {
		uint32_t passed = 0;
		for (uint32_t k = 0; k < rays; k++)
			passed += is_open(r, i, k);
		records[4 * i] = (float)passed / (float)rays;
	}
}

/* Their sum: rays are as dense as the cosine. */
static void find_directions(const open_rays *r, float *records)
{
	const gw_ray_gather *rays = &r->scene->rays;
	for (size_t i = 0; i < r->scene->records.count; i++)
		for (uint32_t k = 0; k < rays->rays; k++) {
			if (!is_open(r, i, k))
				continue;
			gw_vec3 ray = gw_record_ray(gw_xyz(r->position + 4 * i), gw_xyz(r->normal + 4 * i), k,
										rays->rays, rays->seed);
			records[4 * i] += ray.x;
			records[4 * i + 1] += ray.y;
			records[4 * i + 2] += ray.z;
		}
}

static gw_status find_ambient_occlusion(const open_rays *r, float **points, gw_error *error)
{
	const gw_scene *s = r->scene;
	const gw_read_back *rows = &s->read_back;
	float *records = allocate(4 * (size_t)s->records.count, error);
	float *surfels = allocate(4 * s->surfels.count, error);
	gw_status status = records && surfels ? GW_OK : GW_ERROR_MEMORY;
	if (status == GW_OK) {
		find_shares(r, records);
		gw_read_back_apply(rows, records, s->options.threads, surfels);
		for (size_t i = 0; i < s->surfels.count; i++)
			surfels[i] = rows->first[i] == rows->first[i + 1] ? 1.0f : surfels[4 * i];
		status = to_points(r->lighting, 1, surfels, points, error);
	}
	free(records);
	free(surfels);
	return status;
}

/* Of surfels without a record near, nothing being known that hides them, their own normal. */
static void make_unit(const gw_scene *s, float *surfels)
{
	const gw_surfels *of = &s->surfels;
	const float *normal = of->shading_normal ? of->shading_normal : of->normal;
	for (size_t i = 0; i < of->count; i++) {
		bool known = s->read_back.first[i] < s->read_back.first[i + 1];
		gw_vec3 sum = known ? gw_xyz(surfels + 4 * i)
							: (gw_vec3){ normal[3 * i], normal[3 * i + 1], normal[3 * i + 2] };
		if (gw_dot(sum, sum) > 0.0f)
			sum = gw_unit(sum);
		memcpy(surfels + 3 * i, &sum, 3 * sizeof *surfels);
	}
}

static gw_status find_bent_normals(const open_rays *r, float **points, gw_error *error)
{
	const gw_scene *s = r->scene;
	float *records = allocate(4 * (size_t)s->records.count, error);
	float *surfels = allocate(4 * s->surfels.count, error);
	gw_status status = records && surfels ? GW_OK : GW_ERROR_MEMORY;
	if (status == GW_OK) {
		find_directions(r, records);
		gw_read_back_apply(&s->read_back, records, s->options.threads, surfels);
		make_unit(s, surfels);
		status = to_points(r->lighting, 3, surfels, points, error);
	}
	free(records);
	free(surfels);
	return status;
}

static gw_status find_occlusion(const gw_lighting *lighting, gw_bake_result *result,
								gw_error *error)
{
	const gw_scene *s = lighting->scene;
	const bool ambient = s->options.ambient_occlusion, bent = s->options.bent_normals;
	open_rays rays = { .lighting = lighting, .scene = s };
	gw_status status = fetch_rays(&rays, bent, error);
	if (status == GW_OK && ambient)
		status = find_ambient_occlusion(&rays, &result->ambient_occlusion, error);
	if (status == GW_OK && bent)
		status = find_bent_normals(&rays, &result->bent_normal, error);
	clear_rays(&rays);
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
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", s->records.count);
	if (status == GW_OK && lighting->plan.records)
		status = gw_records_light(s->gpu, &s->records, records, error);
	for (size_t i = 0; i < s->surfels.count && status == GW_OK && lighting->plan.records; i++)
		surfels[i] = (float)(sqrt(gw_read_back_variance(&s->read_back, records, i, 1.0)) *
							 gw_luminance(s->surfels.albedo + 3 * i) * 0.31830988618379067);
	if (status == GW_OK)
		status = to_points(lighting, 1, surfels, points, error);
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
		status = to_points(lighting, 1, surfels, points, error);
	free(records);
	free(surfels);
	return status;
}

gw_status gw_record_fields_collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error)
{
	const gw_bake_options *o = &lighting->scene->options;
	GW_TRY(gw_lighting_choose_sides(lighting, error));
	if (gw_options_occlusion(o))
		GW_TRY(find_occlusion(lighting, result, error));
	if (o->unknown)
		GW_TRY(find_unknown(lighting, &result->unknown, error));
	if (o->errors)
		GW_TRY(find_errors(lighting, &result->error, error));
	return GW_OK;
}
