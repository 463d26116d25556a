/*
 * relight.c - see relight.h.
 */
#include "bake/relight.h"
#include "bake/report.h"

#include "light/bounces.h"
#include "light/direct_light.h"
#include "estimate/error_estimate.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Emitters that cover less of the surface than this are sampled; more are light of the voxels. */
#define SAMPLED_SHARE 0.1

#define PATCH_SEED 0x2c1b3c6du

void gw_relight_plan(gw_relight *relight)
{
	gw_solver *solver = relight->solver;
	gw_plan_make(&solver->surfels, relight->lights, relight->light_count, &solver->options,
				 &relight->plan, solver->report);
}

void gw_relight_plan_part(gw_relight *part, bool emission)
{
	const gw_plan *whole = &part->whole->plan;
	gw_plan *plan = &part->plan;
	*plan =
		(gw_plan){ .emitters = whole->emitters && emission,
				   .bounces = whole->bounces,
				   .records = whole->records,
				   .limit = whole->bounces ? part->solver->report->bounce_count : whole->limit };
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

/* A buffer of `count` dark vec4, made when there is none yet. */
static gw_status darken(gw_relight *relight, gw_buffer_kind kind, uint64_t count, const char *name,
						gw_buffer *buffer, gw_error *error)
{
	gw_gpu *gpu = relight->solver->gpu;
	if (buffer->handle != VK_NULL_HANDLE)
		return gw_buffer_fill(gpu, buffer, 0, error);
	VkFormat format = kind == GW_BUFFER_TEXEL ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_UNDEFINED;
	return gw_buffer_create(gpu, kind, format, 16 * count, name, buffer, error);
}

gw_status gw_relight_direct(gw_relight *relight, gw_error *error)
{
	gw_solver *solver = relight->solver;
	uint64_t slots = 2 * (uint64_t)solver->octree.leaf_count;
	gw_status status = darken(relight, GW_BUFFER_TEXEL, solver->surfels.count, "direct irradiance",
							  &relight->surfel_direct, error);
	if (status == GW_OK)
		status = darken(relight, GW_BUFFER_TEXEL, slots, "lobe direct irradiance",
						&relight->lobe_direct, error);
	bool off = relight->plan.lamps && relight->whole == NULL && solver->surfels.lamp_off &&
			   solver->options.estimate_points > 0;
	if (status == GW_OK && off)
		status = darken(relight, GW_BUFFER_TEXEL, solver->surfels.count,
						"irradiance of normals that are off", &relight->surfel_turned, error);
	if (status == GW_OK && relight->plan.lamps)
		status =
			gw_direct_light(&solver->passes, &solver->octree, &solver->surfels, relight->lights,
							relight->light_count, &solver->options, &relight->surfel_direct,
							&relight->lobe_direct, off ? &relight->surfel_turned : NULL, error);
	return status;
}

/* ------------------------------------------------------------------------------ first gather */

static void report_openings(gw_report *report, const gw_openings *openings)
{
	double percent = 100.0 * (double)openings->escaped;
	if (openings->count > 0)
		gw_report_effect(report, "openings", "sampled beside the rays",
						 "%.3g %% of the rays leave the scene; %u cells let most of them through",
						 percent, openings->count);
	else
		gw_report_effect(report, "openings", NULL, "%.3g %% of the rays leave the scene%s", percent,
						 percent > 0.0 ? ", through no narrow opening" : "");
}

static gw_status open_to_sky(gw_relight *relight, gw_error *error)
{
	if (!relight->plan.sky)
		return GW_OK;
	gw_status status = gw_solver_open_to_sky(relight->solver, error);
	if (status == GW_OK)
		report_openings(relight->solver->report, &relight->solver->openings);
	return status;
}

static gw_status first_by_rays(gw_relight *relight, gw_error *error)
{
	gw_solver *s = relight->solver;
	const gw_sampled_sources sources = { .emitters = &relight->emitters,
										 .samples = s->options.light_samples,
										 .use_hits = true,
										 .sky = relight->plan.sky_radiance,
										 .map = &relight->map,
										 .map_samples = s->options.light_samples,
										 .map_hits = true,
										 .openings = &s->openings,
										 .looked = true,
										 .seed = (uint32_t)s->options.seed,
										 .kept = relight->plan.emitters ? &s->sampled : NULL };
	gw_status status = open_to_sky(relight, error);
	if (status == GW_OK && s->further.count > 0 && sources.kept &&
		s->sampled.handle != VK_NULL_HANDLE)
		status = gw_ray_gather_sample_further(&s->passes, &s->octree, &s->further, &s->further_rays,
											  &sources, error);
	gw_solver_forget_further(s);
	return status == GW_OK ? gw_ray_gather_sampled(&s->passes, &s->octree, &s->records, &s->rays,
												   &sources, &s->records.first, error)
						   : status;
}

static float largest_emission(const gw_surfels *surfels)
{
	float largest = 0.0f;
	for (size_t i = 0; i < 3 * surfels->count; i++)
		largest = fmaxf(largest, surfels->emission[i]);
	return largest;
}

static gw_status add_gathered(gw_solver *s, gw_error *error)
{
	return gw_light_add(&s->passes, &s->records.gathered, &s->records.first, s->records.count,
						error);
}

/* Cones see the sky and large emitters; small emitters and the map of the sky are sampled. */
static gw_status first_by_cones(gw_relight *relight, gw_error *error)
{
	const float black[3] = { 0 };
	gw_solver *s = relight->solver;
	const gw_plan *plan = &relight->plan;
	bool in_voxels = plan->emitters && relight->emitters.area_share >= SAMPLED_SHARE;
	const gw_sampled_sources sources = { .emitters = &relight->emitters,
										 .samples = in_voxels ? 0 : s->options.light_samples,
										 .sky = black,
										 .map = &relight->map,
										 .map_samples = s->options.light_samples,
										 .looked = true,
										 .seed = (uint32_t)s->options.seed };
	gw_status status = gw_ray_gather_sampled(&s->passes, &s->octree, &s->records, &s->rays,
											 &sources, &s->records.first, error);
	const float *sky = plan->sky_radiance;
	bool seen = plan->sky && (sky[0] > 0.0f || sky[1] > 0.0f || sky[2] > 0.0f);
	if (status != GW_OK || (!in_voxels && !seen))
		return status;
	status = gw_cone_gather_bounce(&s->passes, &s->octree, &s->cones, &s->records,
								   in_voxels ? &s->octree.lobe_emission : &relight->lobe_radiance,
								   in_voxels ? largest_emission(&s->surfels) : 1.0f,
								   plan->sky_radiance, &s->records.gathered, error);
	return status == GW_OK ? add_gathered(s, error) : status;
}

/* The map serves all rounds. */
static gw_status make_map(gw_relight *relight, gw_error *error)
{
	gw_solver *s = relight->solver;
	if (!relight->plan.map || relight->map_made)
		return GW_OK;
	gw_status status = gw_sky_map_make(s->gpu, relight->plan.map, &relight->map, error);
	relight->map_made = status == GW_OK;
	if (relight->whole)
		return status;
	gw_report_count(s->report, "map_pixels_repaired", relight->map.repaired,
					"pixels of the sky's map that are negative or no number: taken as 0");
	gw_report_count(
		s->report, "map_pixels_infinite", relight->map.infinite,
		"pixels of the sky's map that are infinite or over 1e12: taken as 65504 or 1e12");
	return status;
}

gw_status gw_relight_gather_first(gw_relight *relight, gw_error *error)
{
	gw_solver *s = relight->solver;
	uint64_t slots = 2 * (uint64_t)s->octree.leaf_count;
	gw_status status =
		darken(relight, GW_BUFFER_TEXEL, slots, "lobe radiance", &relight->lobe_radiance, error);
	gw_emitters_destroy(s->gpu, &relight->emitters);
	relight->emitters.radiance = &s->octree.lobe_emission;
	if (status == GW_OK && relight->plan.emitters)
		status = gw_emitters_make(s->gpu, &s->octree, &s->octree.lobe_emission, true,
								  &relight->emitters, error);
	if (status == GW_OK)
		status = make_map(relight, error);
	if (status == GW_OK)
		status = s->options.method == GW_METHOD_RAYS ? first_by_rays(relight, error)
													 : first_by_cones(relight, error);
	return status;
}

/* ----------------------------------------------------------------------------------- bounces */

static gw_status gather_by_rays(void *self, const gw_buffer *lobe_radiance, float largest,
								gw_error *error)
{
	gw_solver *s = ((gw_relight *)self)->solver;
	(void)largest;
	return gw_ray_gather_bounce(&s->passes, &s->rays, lobe_radiance, &s->records, error);
}

/* Parts are sampled by the radiance of the whole, so it is copied. */
static gw_status keep_patches(gw_relight *relight, const gw_buffer *lobe_radiance, gw_error *error)
{
	gw_solver *s = relight->solver;
	uint64_t slots = 2 * (uint64_t)s->octree.leaf_count;
	gw_status status = darken(relight, GW_BUFFER_TEXEL, slots, "radiance of patches",
							  &relight->patch_radiance, error);
	if (status == GW_OK)
		status = gw_light_add(&s->passes, lobe_radiance, &relight->patch_radiance, slots, error);
	relight->patches.radiance = &relight->patch_radiance;
	return status;
}

/* Samples lit lobes, half as often as what emits: patches carry less of the light, and of all that
 * is done for other lamps this takes the longest. part is NULL, or what is gathered of their
 * radiance. */
static gw_status sample_patches(gw_solver *s, const gw_emitters *patches, const gw_buffer *part,
								gw_error *error)
{
	const float black[3] = { 0 };
	const gw_sampled_sources sources = { .emitters = patches,
										 .part = part,
										 .samples = (s->options.light_samples + 1) / 2,
										 .use_hits = true,
										 .sky = black,
										 .looked = true,
										 .seed = (uint32_t)s->options.seed ^ PATCH_SEED };
	return gw_ray_gather_sampled(&s->passes, &s->octree, &s->records, &s->rays, &sources,
								 &s->records.gathered, error);
}

/* What lamps and emitters light is sampled like an emitter: rays would miss small bright patches.
 */
static gw_status gather_patches(void *self, const gw_buffer *lobe_radiance, float largest,
								gw_error *error)
{
	gw_relight *relight = self;
	gw_solver *s = relight->solver;
	if (relight->whole)
		return relight->whole->patches_sampled
				   ? sample_patches(s, &relight->whole->patches, lobe_radiance, error)
				   : gather_by_rays(self, lobe_radiance, largest, error);
	gw_emitters *patches = &relight->patches;
	gw_emitters_destroy(s->gpu, patches);
	gw_status status = gw_emitters_make(s->gpu, &s->octree, lobe_radiance, false, patches, error);
	if (status != GW_OK)
		return status;
	relight->patches_sampled = gw_emitters_are_small(patches);
	status = relight->patches_sampled ? sample_patches(s, patches, NULL, error)
									  : gather_by_rays(self, lobe_radiance, largest, error);
	if (status == GW_OK && relight->kept && relight->patches_sampled)
		status = keep_patches(relight, lobe_radiance, error);
	else
		gw_emitters_destroy(s->gpu, patches);
	return status;
}

static gw_status gather_by_cones(void *self, const gw_buffer *lobe_radiance, float largest,
								 gw_error *error)
{
	gw_solver *s = ((gw_relight *)self)->solver;
	const float black[3] = { 0 };
	return gw_cone_gather_bounce(&s->passes, &s->octree, &s->cones, &s->records, lobe_radiance,
								 largest, black, &s->records.gathered, error);
}

/* The guess at the surfels' light, as the mean over each lobe. */
static gw_status carry(const gw_relight *relight, gw_buffer *lobes, gw_error *error)
{
	gw_solver *s = relight->solver;
	gw_buffer surfels = { 0 };
	uint64_t bytes = 16 * (uint64_t)s->surfels.count;
	gw_status status = gw_buffer_create(s->gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
										bytes, "carried irradiance", &surfels, error);
	if (status == GW_OK)
		status = gw_buffer_upload(s->gpu, &surfels, 0, relight->carried, bytes, error);
	if (status == GW_OK)
		status = gw_buffer_create(s->gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
								  32 * (uint64_t)s->octree.leaf_count, "carried light of lobes",
								  lobes, error);
	if (status == GW_OK)
		status = gw_average_lobes(&s->passes, &s->octree, &surfels, lobes, error);
	gw_buffer_destroy(s->gpu, &surfels);
	return status;
}

gw_status gw_relight_bounce(gw_relight *relight, gw_error *error)
{
	gw_solver *s = relight->solver;
	gw_report *report = s->report;
	bool rays = s->options.method == GW_METHOD_RAYS;
	gw_bounces bounces;
	gw_bounces_task task = { .passes = &s->passes,
							 .octree = &s->octree,
							 .records = &s->records,
							 .lobe_direct = &relight->lobe_direct,
							 .lobe_radiance = &relight->lobe_radiance,
							 .step = { .gather = rays ? gather_by_rays : gather_by_cones,
									   .gather_first = rays ? gather_patches : NULL,
									   .hits = rays ? &s->rays : NULL,
									   .self = relight },
							 .limit = relight->plan.bounces ? relight->plan.limit : 1,
							 .tolerance = s->options.tolerance,
							 .no_bound = relight->whole != NULL,
							 .cancelled = s->cancelled,
							 .user = s->user };
	gw_buffer carried = { 0 };
	gw_status status = gw_buffer_fill(s->gpu, &s->records.indirect, 0, error);
	if (status == GW_OK && rays && relight->carried && task.limit == GW_BOUNCES_AUTO) {
		status = carry(relight, &carried, error);
		task.carried = &carried;
	}
	if (status == GW_OK)
		status = gw_bounces_run(&task, &bounces, error);
	gw_buffer_destroy(s->gpu, &carried);
	if (status != GW_OK)
		return status;
	if (relight->whole) {
		free(bounces.bounce);
		return GW_OK;
	}
	free(report->bounce);
	report->bounce = bounces.bounce;
	report->bounce_count = bounces.bounce_count;
	report->remaining = bounces.remaining;
	return GW_OK;
}

/* --------------------------------------------------------------------------------- read back */

/* Interpolates an irradiance of the records at every surfel. */
static gw_status read_back(const gw_solver *s, const gw_buffer *irradiance, float *records,
						   float **surfels, gw_error *error)
{
	gw_status status =
		gw_buffer_download(s->gpu, irradiance, 0, records, 16 * (uint64_t)s->records.count, error);
	if (status != GW_OK)
		return status;
	if (!*surfels)
		*surfels = gw_allocate_array(s->surfels.count, 4 * sizeof **surfels);
	if (!*surfels)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for the light of %zu surfels",
					   s->surfels.count);
	gw_read_back_apply(&s->read_back, records, s->options.threads, *surfels);
	return GW_OK;
}

gw_status gw_relight_read_back(gw_relight *relight, gw_error *error)
{
	const gw_solver *s = relight->solver;
	float *records = gw_allocate_array(s->records.count, 4 * sizeof *records);
	gw_status status = records ? GW_OK
							   : gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u records",
										 s->records.count);
	if (status == GW_OK)
		status = read_back(s, &s->records.first, records, &relight->surfel_first, error);
	if (status == GW_OK)
		status = read_back(s, &s->records.indirect, records, &relight->surfel_indirect, error);
	free(records);
	return status;
}

gw_status gw_relight_run(gw_relight *relight, gw_error *error)
{
	gw_status status = gw_relight_direct(relight, error);
	if (status == GW_OK && relight->plan.records)
		status = gw_relight_gather_first(relight, error);
	if (status == GW_OK && relight->plan.records)
		status = gw_relight_bounce(relight, error);
	if (status == GW_OK && relight->plan.records)
		status = gw_relight_read_back(relight, error);
	return status;
}

static gw_status download(const gw_relight *relight, const gw_buffer *buffer, float **direct,
						  gw_error *error)
{
	const gw_solver *s = relight->solver;
	*direct = gw_allocate_array(s->surfels.count, 4 * sizeof **direct);
	if (!*direct)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for the light of %zu surfels",
					   s->surfels.count);
	gw_status status =
		gw_buffer_download(s->gpu, buffer, 0, *direct, 16 * (uint64_t)s->surfels.count, error);
	if (status != GW_OK) {
		free(*direct);
		*direct = NULL;
	}
	return status;
}

gw_status gw_relight_download_direct(const gw_relight *relight, float **direct, gw_error *error)
{
	return download(relight, &relight->surfel_direct, direct, error);
}

/* Rays that light comes along to what an estimate is held against. */
static uint32_t rays_of(const gw_bake_options *o)
{
	return o->method == GW_METHOD_RAYS ? o->rays : o->light_samples;
}

gw_status gw_relight_foresee(gw_relight *relight, gw_error *error)
{
	gw_solver *s = relight->solver;
	const gw_probe_task task = { .passes = &s->passes,
								 .octree = &s->octree,
								 .surfels = &s->surfels,
								 .emitters = &relight->emitters,
								 .rays = gw_estimate_rays(rays_of(&s->options)),
								 .seed = (uint32_t)s->options.seed };
	return s->probed.count > 0
			   ? GW_OK
			   : gw_estimate_foresee(
					 &task, gw_estimate_points(s->options.estimate_points, s->records.count),
					 &s->probed, error);
}

gw_status gw_relight_estimate(gw_relight *relight, gw_error *error)
{
	gw_solver *s = relight->solver;
	const gw_bake_options *o = &s->options;
	float *direct = NULL, *turned = NULL;
	gw_status status =
		relight->plan.lamps ? gw_relight_download_direct(relight, &direct, error) : GW_OK;
	if (status == GW_OK && relight->surfel_turned.handle != VK_NULL_HANDLE)
		status = download(relight, &relight->surfel_turned, &turned, error);
	if (status == GW_OK) {
		const gw_estimate_task task = { .passes = &s->passes,
										.octree = &s->octree,
										.surfels = &s->surfels,
										.records = relight->plan.records ? &s->records : NULL,
										.read_back = &s->read_back,
										.rays_of_records = &s->rays,
										.emitters = &relight->emitters,
										.lobe_direct = &relight->lobe_direct,
										.sky = relight->plan.sky_radiance,
										.map = &relight->map,
										.openings = &s->openings,
										.bounces = relight->plan.bounces,
										.direct = direct,
										.turned = turned,
										.first = relight->surfel_first,
										.indirect = relight->surfel_indirect,
										.rays = rays_of(o),
										.light_samples = o->light_samples,
										.points = gw_estimate_points(o->estimate_points,
																	 s->records.count),
										.seed = (uint32_t)o->seed,
										.threads = o->threads,
										.lights = relight->lights,
										.light_count = relight->light_count,
										.options = o,
										.limit = relight->plan.bounces ? relight->plan.limit : 1,
										.hits = &s->probed };
		status = gw_estimate_error(&task, &s->report->error, error);
	}
	free(turned);
	free(direct);
	return status;
}

void gw_relight_drop_gathered(gw_relight *relight)
{
	gw_gpu *gpu = relight->solver->gpu;
	free(relight->surfel_first);
	free(relight->surfel_indirect);
	relight->surfel_first = relight->surfel_indirect = NULL;
	gw_buffer_destroy(gpu, &relight->lobe_radiance);
	gw_buffer_destroy(gpu, &relight->patch_radiance);
	gw_emitters_destroy(gpu, &relight->patches);
	gw_emitters_destroy(gpu, &relight->emitters);
}

void gw_relight_clear(gw_relight *relight)
{
	if (relight->solver == NULL || relight->solver->gpu == NULL)
		return;
	gw_relight_drop_gathered(relight);
	gw_sky_map_destroy(relight->solver->gpu, &relight->map);
	relight->map_made = false;
	gw_buffer_destroy(relight->solver->gpu, &relight->surfel_direct);
	gw_buffer_destroy(relight->solver->gpu, &relight->surfel_turned);
	gw_buffer_destroy(relight->solver->gpu, &relight->lobe_direct);
}
