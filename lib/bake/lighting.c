/*
 * lighting.c - see lighting.h.
 */
#include "bake/lighting.h"
#include "bake/report.h"
#include "bake/scene_records.h"

#include "light/direct_light.h"
#include "light/lamp_reach.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "surfels/surfel_backs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void gw_lighting_plan(gw_lighting *lighting)
{
	gw_scene *scene = lighting->scene;
	const gw_plan_task task = { &scene->surfels, lighting->lights, lighting->light_count,
								&scene->options };
	gw_plan_make(&task, &lighting->plan, scene->report);
}

void gw_lighting_plan_part(gw_lighting *part, bool emission)
{
	const gw_plan *whole = &part->whole->plan;
	gw_plan *plan = &part->plan;
	*plan = (gw_plan){ .emitters = whole->emitters && emission,
					   .bounces = whole->bounces,
					   .records = whole->records,
					   .shadows = whole->shadows,
					   .portals = whole->portals,
					   .gaps = whole->gaps,
					   .octree = whole->octree,
					   .limit = whole->bounces ? part->scene->report->bounce_count : whole->limit };
	for (size_t i = 0; i < part->light_count; i++) {
		plan->lamps |= whole->lamps && gw_light_shines(&part->lights[i]);
		bool sky = part->lights[i].type == GW_LIGHT_ENVIRONMENT;
		if (sky && part->lights[i].map)
			plan->map = whole->map ? &part->lights[i] : NULL;
		for (int c = 0; c < 3 && sky && !part->lights[i].map; c++)
			plan->sky_radiance[c] += part->lights[i].radiance[c];
	}
	plan->sky = whole->sky && (plan->map || plan->sky_radiance[0] > 0.0f ||
							   plan->sky_radiance[1] > 0.0f || plan->sky_radiance[2] > 0.0f);
}

gw_status gw_lighting_darken(gw_lighting *lighting, gw_buffer_kind kind, uint64_t count,
							 const char *name, gw_buffer *buffer, gw_error *error)
{
	gw_gpu *gpu = lighting->scene->gpu;
	if (buffer->handle != VK_NULL_HANDLE)
		return gw_buffer_fill(gpu, buffer, 0, error);
	VkFormat format = kind == GW_BUFFER_TEXEL ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_UNDEFINED;
	return gw_buffer_create(gpu, &(gw_buffer_description){ kind, format, 16 * count, name }, buffer,
							error);
}

/* Those that have no power, or reach nothing. */
gw_status gw_lighting_list_lights(gw_lighting *lighting, gw_error *error)
{
	const gw_scene *scene = lighting->scene;
	free(lighting->given);
	lighting->given = NULL;
	if (lighting->whole)
		return GW_OK;
	lighting->given = gw_allocate_zeros(lighting->light_count + 1, sizeof *lighting->given);
	if (!lighting->given)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", lighting->light_count);
	for (size_t i = 0; i < lighting->light_count; i++) {
		const gw_light *light = &lighting->lights[i];
		bool sky = light->type == GW_LIGHT_ENVIRONMENT;
		bool shines = sky ? gw_luminance(light->radiance) > 0.0 : gw_light_shines(light);
		bool averted =
			shines && !sky && !gw_lamp_reaches(light, &scene->surfels, scene->options.threads);
		bool used = sky ? lighting->plan.sky : lighting->plan.lamps;
		lighting->given[i].fate = !shines   ? GW_LIGHT_BLACK
								  : averted ? GW_LIGHT_AVERTED
								  : used    ? GW_LIGHT_SHINES
											: GW_LIGHT_LEFT_OUT;
	}
	return GW_OK;
}

static void drop_direct(gw_lighting *lighting)
{
	gw_gpu *gpu = lighting->scene->gpu;
	gw_buffer_destroy(gpu, &lighting->surfel_direct);
	gw_buffer_destroy(gpu, &lighting->surfel_turned);
	gw_buffer_destroy(gpu, &lighting->facet_direct);
}

/* Which of the lights that are known this lighting is of. */
static const float *known_of(const gw_lighting *lighting)
{
	const gw_known_light *known = lighting->scene->known;
	const gw_lighting *whole = lighting->whole;
	if (!whole)
		return known->all;
	if (lighting->light_count == 0)
		return known->rest;
	return known->lamp ? known->lamp[lighting->lights - whole->lights] : NULL;
}

static void enter_known(const gw_scene *scene, const float *known, const uint32_t *back,
						float *irradiance)
{
	const gw_surfels *s = &scene->surfels;
	for (size_t i = 0; i < s->point_count; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		if (surfel == UINT32_MAX || isnan(known[3 * i]) || scene->region.lit[surfel])
			continue;
		for (size_t c = 0; c < 3; c++)
			irradiance[4 * (size_t)surfel + c] = known[3 * i + c] * scene->known_unit;
		if (back && back[surfel] != UINT32_MAX)
			memcpy(irradiance + 4 * (size_t)back[surfel], irradiance + 4 * (size_t)surfel,
				   3 * sizeof *irradiance);
	}
}

/* Points whose light is known have it as that of lamps, so that facets reflect it and gather
 * nothing more; whichever side of them is shown, it is that of both. */
static gw_status take_known(gw_lighting *lighting, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	const float *known = known_of(lighting);
	uint64_t bytes = 16 * (uint64_t)scene->surfels.count;
	uint32_t *back = NULL;
	if (!known || !scene->region.lit)
		return GW_OK; /* nothing gathers it */
	float *irradiance = gw_allocate_array(scene->surfels.count, 4 * sizeof *irradiance);
	gw_status status = irradiance ? gw_surfel_backs_find(&scene->surfels, &back, error)
								  : gw_fail(error, GW_ERROR_MEMORY, "no memory for light");
	if (status == GW_OK)
		status =
			gw_buffer_download(scene->gpu, &lighting->surfel_direct, 0, irradiance, bytes, error);
	if (status == GW_OK) {
		enter_known(scene, known, back, irradiance);
		status =
			gw_buffer_upload(scene->gpu, &lighting->surfel_direct, 0, irradiance, bytes, error);
	}
	if (status == GW_OK)
		status = gw_average_facets(&scene->passes, &scene->octree, &lighting->surfel_direct,
								   &lighting->facet_direct, error);
	free(back);
	free(irradiance);
	return status;
}

gw_status gw_lighting_direct(gw_lighting *lighting, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	uint64_t facets = scene->octree.facet_count;
	GW_TRY(gw_lighting_list_lights(lighting, error));
	if (!lighting->plan.lamps && !scene->known) {
		drop_direct(lighting);
		return GW_OK;
	}
	GW_TRY(gw_lighting_darken(lighting, GW_BUFFER_TEXEL, scene->surfels.count, "direct irradiance",
							  &lighting->surfel_direct, error));
	if (facets > 0)
		GW_TRY(gw_lighting_darken(lighting, GW_BUFFER_TEXEL, facets, "facet direct irradiance",
								  &lighting->facet_direct, error));
	const gw_lit_cloud cloud = { .passes = &scene->passes,
								 .octree = &scene->octree,
								 .surfels = &scene->surfels,
								 .options = &scene->options,
								 .lit = scene->region.lit,
								 .asked = scene->region.asked,
								 .closed = gw_scene_closed_space(scene) };
	if (lighting->plan.shadows || lighting->plan.records) /* which find them later if not here */
		GW_TRY(gw_scene_find_compartments(scene, error));
	size_t lights = lighting->plan.lamps ? lighting->light_count : 0;
	bool off = lights > 0 && lighting->whole == NULL && scene->surfels.shading_normal_off &&
			   lighting->plan.error;
	if (off)
		GW_TRY(gw_lighting_darken(lighting, GW_BUFFER_TEXEL, scene->surfels.count,
								  "irradiance of normals that are off", &lighting->surfel_turned,
								  error));
	const gw_direct_irradiance to = { &lighting->surfel_direct, &lighting->facet_direct,
									  lighting->given, off ? &lighting->surfel_turned : NULL };
	GW_TRY(gw_direct_light(&cloud, lighting->lights, lights, &to, error));
	return scene->known ? take_known(lighting, error) : GW_OK;
}

gw_status gw_lighting_view(const gw_lighting *lighting, const gw_buffer *buffer, gw_view *view,
						   gw_error *error)
{
	const gw_scene *s = lighting->scene;
	*view = (gw_view){ 0 };
	if (buffer->handle == VK_NULL_HANDLE)
		return GW_OK;
	return gw_view_open(s->gpu, buffer, 16 * (uint64_t)s->surfels.count, view, error);
}

/* What a surfel gets from lamps and from all around, in luminance. */
static double light_of(const gw_lighting *lighting, const float *direct, size_t surfel)
{
	const float *from[] = { direct, lighting->surfel_first, lighting->surfel_indirect };
	double sum = 0.0;
	for (size_t i = 0; i < sizeof from / sizeof *from; i++)
		sum += from[i] ? gw_luminance(from[i] + 4 * surfel) : 0.0;
	return sum;
}

gw_status gw_lighting_choose_sides(gw_lighting *lighting, gw_error *error)
{
	const gw_surfels *s = &lighting->scene->surfels;
	gw_view direct;
	uint32_t *shown;
	free(lighting->shown);
	lighting->shown = NULL;
	GW_TRY(gw_surfel_backs_find(s, &shown, error));
	if (!shown)
		return GW_OK;
	gw_status status = gw_lighting_view(lighting, &lighting->surfel_direct, &direct, error);
	for (size_t i = 0; i < s->count && status == GW_OK; i++) {
		bool turned = shown[i] != UINT32_MAX && light_of(lighting, direct.bytes, shown[i]) >
													light_of(lighting, direct.bytes, i);
		shown[i] = turned ? shown[i] : (uint32_t)i;
	}
	gw_view_close(&direct);
	if (status == GW_OK)
		lighting->shown = shown;
	else
		free(shown);
	return status;
}

uint32_t gw_lighting_shown(const gw_lighting *lighting, uint32_t surfel)
{
	const gw_lighting *all = lighting->whole ? lighting->whole : lighting;
	return all->shown && surfel != UINT32_MAX ? all->shown[surfel] : surfel;
}

void gw_lighting_drop_gathered(gw_lighting *lighting)
{
	gw_gpu *gpu = lighting->scene->gpu;
	free(lighting->surfel_first);
	free(lighting->surfel_indirect);
	free(lighting->gap);
	free(lighting->shown);
	lighting->gap = NULL;
	lighting->shown = NULL;
	lighting->surfel_first = lighting->surfel_indirect = NULL;
	gw_buffer_destroy(gpu, &lighting->facet_radiance);
	gw_buffer_destroy(gpu, &lighting->patch_radiance);
	gw_emitters_destroy(gpu, &lighting->patches);
	gw_emitters_destroy(gpu, &lighting->emitters);
}

void gw_lighting_drop_map(gw_lighting *lighting)
{
	gw_sky_map_destroy(lighting->scene->gpu, &lighting->map);
	lighting->map_made = false;
}

void gw_lighting_clear(gw_lighting *lighting)
{
	if (lighting->scene == NULL || lighting->scene->gpu == NULL)
		return;
	gw_lighting_drop_gathered(lighting);
	gw_lighting_drop_map(lighting);
	free(lighting->given);
	lighting->given = NULL;
	drop_direct(lighting);
}
