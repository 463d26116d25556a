/*
 * result.c - see result.h. L = Le + rho / pi * E.
 */
#include "bake/result.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "bake/lighting_steps.h"
#include "bake/region.h"
#include "bake/report.h"
#include "bake/voxels.h"
#include "cloud/surfels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static gw_status allocate_result(size_t count, gw_bake_result *result, gw_error *error)
{
	result->count = count;
	float **vectors[] = { &result->radiance, &result->direct_irradiance,
						  &result->indirect_irradiance, &result->normal, &result->albedo };
	bool complete = (result->roi = gw_allocate_zeros(count, sizeof(float))) != NULL;
	for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
		complete &= (*vectors[i] = gw_allocate_zeros(count, 3 * sizeof(float))) != NULL;
	if (!complete)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", count);
	return GW_OK;
}

typedef struct scatter {
	const gw_lighting *lighting;
	const float *direct; /* 4 a surfel, from lamps */
	gw_bake_result *result;
} scatter;

static float component(const float *values, size_t surfel, size_t c)
{
	return values ? values[4 * surfel + c] : 0.0f;
}

/* Light of the points first..last-1. */
static void scatter_points(void *user, size_t first, size_t last, uint32_t worker)
{
	const scatter *job = user;
	const gw_lighting *light = job->lighting;
	const gw_surfels *surfels = &light->scene->surfels;
	gw_bake_result *out = job->result;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint32_t own = surfels->surfel_of_point[i], s = gw_lighting_shown(light, own);
		if (s == UINT32_MAX || !gw_region_has(light->scene, i))
			continue;
		const float *rho = gw_albedo_of_point(surfels, i, s);
		out->roi[i] = fminf(1.0f, surfels->nearest[s] / light->scene->octree.leaf_size);
		for (size_t c = 0; c < 3; c++) {
			float direct = component(job->direct, s, c) + component(light->surfel_first, s, c);
			float indirect = component(light->surfel_indirect, s, c);
			float emission = surfels->emission ? surfels->emission[3 * s + c] : 0.0f;
			out->direct_irradiance[3 * i + c] = direct;
			out->indirect_irradiance[3 * i + c] = indirect;
			out->albedo[3 * i + c] = rho[c];
			out->normal[3 * i + c] =
				(surfels->shading_normal ? surfels->shading_normal : surfels->normal)[3 * own + c];
			out->radiance[3 * i + c] = emission + rho[c] * 0.318309886f * (direct + indirect);
		}
	}
}

/* Strays have the light of the surface that is nearest. */
static gw_status collect_strays(const scatter *job, gw_error *error)
{
	const gw_lighting *light = job->lighting;
	const gw_surfels *surfels = &light->scene->surfels;
	gw_bake_result *out = job->result;
	if (surfels->stray_count == 0)
		return GW_OK;
	out->stray = gw_allocate_zeros(surfels->point_count, 1);
	if (!out->stray)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to mark strays");
	for (size_t j = 0; j < surfels->stray_count; j++) {
		const gw_stray *stray = &surfels->stray[j];
		size_t i = stray->point, own = stray->surfel, s = gw_lighting_shown(light, stray->surfel);
		out->stray[i] = (uint8_t)(1 + stray->kind);
		bool lit = stray->surfel != UINT32_MAX && gw_region_has(light->scene, i);
		for (size_t c = 0; c < 3 && lit; c++) {
			float direct = component(job->direct, s, c) + component(light->surfel_first, s, c);
			float indirect = component(light->surfel_indirect, s, c);
			out->direct_irradiance[3 * i + c] = direct;
			out->indirect_irradiance[3 * i + c] = indirect;
			out->albedo[3 * i + c] = stray->albedo[c];
			out->normal[3 * i + c] =
				(surfels->shading_normal ? surfels->shading_normal : surfels->normal)[3 * own + c];
			out->radiance[3 * i + c] =
				stray->emission[c] + stray->albedo[c] * 0.318309886f * (direct + indirect);
		}
	}
	return GW_OK;
}

/* What skies and emitters give: the flux of what was gathered first. */
static double gathered_flux(const gw_lighting *lighting)
{
	const gw_surfels *s = &lighting->scene->surfels;
	const bool *asked = lighting->scene->region.asked;
	double flux = 0.0;
	for (size_t i = 0; lighting->surfel_first && i < s->count; i++)
		if (!asked || asked[i])
			flux += (double)s->area[i] * gw_luminance(lighting->surfel_first + 4 * i);
	return flux;
}

gw_status gw_result_share_light(gw_lighting *lighting, gw_bake_result *result, gw_error *error)
{
	size_t count = lighting->light_count, skies = 0;
	double gathered = gathered_flux(lighting), all = gathered;
	if (lighting->scene->options.bounces == 0)
		return GW_OK;
	if (!lighting->given)
		GW_TRY(gw_lighting_list_lights(lighting, error));
	if (!lighting->given) /* a part of another lighting */
		return GW_OK;
	free(result->given);
	result->given = gw_allocate_zeros(count + 1, sizeof *result->given);
	if (!result->given)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", count);
	result->given_count = count;
	for (size_t i = 0; i < count; i++) {
		bool sky = lighting->lights[i].type == GW_LIGHT_ENVIRONMENT;
		skies += sky && lighting->given[i].fate == GW_LIGHT_SHINES;
		all += lighting->given[i].share;
	}
	for (size_t i = 0; i < count; i++) {
		gw_light_given *to = &result->given[i];
		*to = lighting->given[i];
		to->share = all > 0.0 ? to->share / all : 0.0;
		if (lighting->lights[i].type != GW_LIGHT_ENVIRONMENT || to->fate != GW_LIGHT_SHINES)
			continue;
		bool alone = skies == 1 && !lighting->plan.emitters;
		to->share = !alone ? (double)NAN : all > 0.0 ? gathered / all : 0.0;
		if (alone && !(gathered > 0.0))
			to->fate = GW_LIGHT_HIDDEN;
	}
	result->gathered_share = all > 0.0 ? gathered / all : 0.0;
	return GW_OK;
}

/* Which points are lit, where some are not. */
static gw_status copy_asked(const gw_scene *scene, gw_bake_result *result, gw_error *error)
{
	if (!scene->region.point)
		return GW_OK;
	result->asked = gw_allocate_array(result->count, sizeof *result->asked);
	if (!result->asked)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to mark the points of a region");
	memcpy(result->asked, scene->region.point, result->count);
	return GW_OK;
}

gw_status gw_result_collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error)
{
	const gw_scene *scene = lighting->scene;
	size_t points = scene->surfels.point_count;
	gw_view direct = { 0 };
	gw_status status = gw_lighting_choose_sides(lighting, error);
	if (status == GW_OK)
		status = allocate_result(points, result, error);
	if (status == GW_OK)
		status = gw_lighting_view(lighting, &lighting->surfel_direct, &direct, error);
	if (status == GW_OK) {
		const uint32_t *row = scene->read_back.first;
		uint64_t lost = 0;
		for (size_t i = 0; lighting->surfel_first && i < scene->surfels.count; i++)
			lost += row[i] == row[i + 1] && scene->surfels.two_sided[i] != GW_SIDE_BACK &&
					(!scene->region.asked || scene->region.asked[i]);
		gw_report_count(scene->report, "without_record", lost,
						"point{|s} with no record near: no gathered light");
		scatter job = { lighting, direct.bytes, result };
		gw_parallel_for(gw_thread_count(scene->options.threads), points, 8192, scatter_points,
						&job);
		status = collect_strays(&job, error);
	}
	if (status == GW_OK)
		status = copy_asked(scene, result, error);
	gw_view_close(&direct);
	return status == GW_OK ? gw_result_share_light(lighting, result, error) : status;
}

/* L of the points, or of a part of the light. */
typedef struct part_radiance {
	const gw_lighting *light;
	const float *direct;
	bool emission;
	float *radiance;
} part_radiance;

static void scatter_radiance(void *user, size_t first, size_t last, uint32_t worker)
{
	const part_radiance *job = user;
	const gw_surfels *surfels = &job->light->scene->surfels;
	const float *emission = job->emission ? surfels->emission : NULL;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint32_t s = gw_lighting_shown(job->light, surfels->surfel_of_point[i]);
		if (s == UINT32_MAX || !gw_region_has(job->light->scene, i))
			continue;
		const float *rho = gw_albedo_of_point(surfels, i, s);
		for (size_t c = 0; c < 3; c++) {
			float irradiance = component(job->direct, s, c) +
							   component(job->light->surfel_first, s, c) +
							   component(job->light->surfel_indirect, s, c);
			job->radiance[3 * i + c] =
				(emission ? emission[3 * s + c] : 0.0f) + rho[c] * 0.318309886f * irradiance;
		}
	}
}

static void add_strays(const part_radiance *job)
{
	const gw_surfels *surfels = &job->light->scene->surfels;
	for (size_t j = 0; j < surfels->stray_count; j++) {
		const gw_stray *stray = &surfels->stray[j];
		size_t s = gw_lighting_shown(job->light, stray->surfel);
		bool lit = stray->surfel != UINT32_MAX && gw_region_has(job->light->scene, stray->point);
		for (size_t c = 0; c < 3 && lit; c++) {
			float irradiance = component(job->direct, s, c) +
							   component(job->light->surfel_first, s, c) +
							   component(job->light->surfel_indirect, s, c);
			job->radiance[3 * (size_t)stray->point + c] =
				(job->emission ? stray->emission[c] : 0.0f) +
				stray->albedo[c] * 0.318309886f * irradiance;
		}
	}
}

/* With their emission or without. */
static gw_status write_radiance(const gw_lighting *lighting, bool emission, float *radiance,
								gw_error *error)
{
	const gw_scene *scene = lighting->scene;
	gw_view direct = { 0 };
	gw_status status = gw_lighting_view(lighting, &lighting->surfel_direct, &direct, error);
	if (status == GW_OK) {
		part_radiance job = { lighting, direct.bytes, emission, radiance };
		gw_parallel_for(gw_thread_count(scene->options.threads), scene->surfels.point_count, 8192,
						scatter_radiance, &job);
		add_strays(&job);
	}
	gw_view_close(&direct);
	return status;
}

gw_status gw_result_radiance(gw_lighting *lighting, float *radiance, gw_error *error)
{
	GW_TRY(gw_lighting_choose_sides(lighting, error));
	memset(radiance, 0, 3 * lighting->scene->surfels.point_count * sizeof *radiance);
	return write_radiance(lighting, true, radiance, error);
}

/* Lights one part and brings its radiance to the points. */
static gw_status light_part(gw_lighting *part, bool emission, float **radiance, gw_error *error)
{
	size_t points = part->scene->surfels.point_count;
	*radiance = gw_allocate_zeros(points, 3 * sizeof **radiance);
	if (!*radiance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", points);
	gw_lighting_plan_part(part, emission);
	GW_TRY(gw_lighting_run(part, error));
	return write_radiance(part, emission, *radiance, error);
}

gw_status gw_result_collect_lamps(const gw_lighting *lighting, gw_bake_result *result,
								  gw_error *error)
{
	gw_lighting part = { .scene = lighting->scene, .whole = lighting };
	const gw_scene *scene = lighting->scene;
	gw_status status = GW_OK;
	result->lamp = gw_allocate_zeros(lighting->light_count, sizeof *result->lamp);
	if (!result->lamp)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", lighting->light_count);
	result->lamp_count = lighting->light_count;
	for (size_t i = 0; i < lighting->light_count && status == GW_OK; i++) {
		if (gw_scene_stopped(lighting->scene))
			status =
				gw_fail(error, GW_ERROR_CANCELLED, "the bake was stopped before light %zu", i + 1);
		part.lights = &lighting->lights[i];
		part.light_count = 1;
		if (status == GW_OK)
			status = light_part(&part, false, &result->lamp[i], error);
	}
	part.light_count = 0;
	if (status == GW_OK && scene->surfels.emission)
		status = light_part(&part, true, &result->rest, error);
	gw_lighting_clear(&part);
	return status;
}

gw_status gw_result_collect_voxels(gw_lighting *lighting, gw_bake_result *result, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	gw_voxels_task task = { .passes = &scene->passes,
							.octree = &scene->octree,
							.surfels = &scene->surfels,
							.records = lighting->plan.records ? &scene->records : NULL,
							.facet_direct = &lighting->facet_direct };
	return gw_voxels_collect(&task, &result->voxels, error);
}

void gw_bake_result_destroy(gw_bake_result **result)
{
	gw_bake_result *r = *result;
	if (r == NULL)
		return;
	free(r->radiance);
	free(r->direct_irradiance);
	free(r->indirect_irradiance);
	free(r->normal);
	free(r->albedo);
	for (size_t i = 0; r->lamp && i < r->lamp_count; i++)
		free(r->lamp[i]);
	free(r->lamp);
	free(r->rest);
	free(r->ambient_occlusion);
	free(r->bent_normal);
	free(r->error);
	free(r->unknown);
	free(r->roi);
	free(r->stray);
	free(r->asked);
	free(r->given);
	gw_voxels_clear(&r->voxels);
	free(r->volume.cell);
	free(r->volume.radiance);
	free(r->report.bounce);
	free(r);
	*result = NULL;
}
