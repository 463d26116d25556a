/*
 * bake.c - gw_bake: the data's way from points to lit points, see glowworm.h.
 */
#include "bounces.h"
#include "clock.h"
#include "direct_light.h"
#include "error_estimate.h"
#include "memory.h"
#include "parallel.h"
#include "plan.h"
#include "refine.h"
#include "report.h"
#include "voxels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rays a record that only look for the nearest surface, when cones gather. */
#define NEAREST_RAYS 16u

/* Emitters that cover less of the surface than this are sampled; more are light of the voxels. */
#define SAMPLED_SHARE 0.1

#define PATCH_SEED 0x2c1b3c6du

/* All that one bake holds. */
typedef struct bake {
	const gw_points *points;
	const gw_light *lights;
	size_t light_count;
	gw_bake_options options;
	gw_bake_callbacks callbacks;
	gw_bake_result *result;
	gw_report *report;
	double start;        /* of the call */
	double round_start;  /* of the round under way */
	double octree_start; /* of the octree in use, and what it and the direct light took */
	double octree_seconds;
	bool refining;       /* the first round is over */

	gw_gpu *gpu;
	gw_surfels surfels;
	gw_octree octree;
	gw_plan plan;
	gw_passes passes;
	gw_emitters emitters;
	gw_records records;
	gw_ray_gather rays;
	gw_cone_gather cones;
	gw_buffer surfel_direct, surfel_first, surfel_indirect; /* vec4 a surfel */
	gw_buffer lobe_direct, lobe_radiance;                   /* vec4 a lobe */
} bake;

static bool cancelled(void *user)
{
	const bake *b = user;
	return b->callbacks.cancelled != NULL && b->callbacks.cancelled(b->callbacks.user);
}

/* Begins a stage: books it, tells the caller, asks whether to stop. All rounds after the first are
 * booked as one. */
static gw_status stage(bake *b, const char *name, double done, gw_error *error)
{
	if (!b->refining)
		gw_report_stage(b->report, b->gpu, name);
	if (b->callbacks.progress)
		b->callbacks.progress(b->callbacks.user, name, done);
	if (cancelled(b))
		return gw_fail(error, GW_ERROR_CANCELLED, "the bake was stopped before its stage '%s'",
					   name);
	return GW_OK;
}

static gw_status check_number(const char *option, double value, double low, double high,
							  gw_error *error)
{
	if (!(value >= low && value <= high))
		return gw_fail(error, GW_ERROR_USAGE, "%s is %g; give a number from %g to %g", option,
					   value, low, high);
	return GW_OK;
}

static bool refines(const gw_bake_options *o)
{
	return o->max_error > 0.0f || o->time_limit > 0.0f;
}

static gw_status check_options(const bake *b, gw_error *error)
{
	const gw_bake_options *o = &b->options;
	const struct {
		const char *name;
		double value, low, high;
	} rows[] = {
		{ "depth", o->depth == GW_DEPTH_AUTO ? 1 : o->depth, 1, GW_DEPTH_MAX },
		{ "leaf spacing", (double)o->leaf_spacing, 0.25, 64 },
		{ "tolerance", (double)o->tolerance, 1e-6, 0.999 },
		{ "rays", o->rays, 1, 4096 },
		{ "light samples", o->light_samples, 1, 4096 },
		{ "cones", o->cones, 1, 256 },
		{ "record spacing", (double)o->record_spacing, 0, 64 },
		{ "shadow map size", o->shadow_map_size, 16, 8192 },
		{ "largest error", (double)o->max_error, 0, 1 },
		{ "time limit", (double)o->time_limit, 0, 1e9 },
		{ "method", (double)o->method, 0, GW_METHOD_COUNT - 1 },
		{ "shadows", (double)o->shadows, 0, GW_SHADOWS_COUNT - 1 },
	};
	gw_status status = GW_OK;
	for (size_t i = 0; i < sizeof rows / sizeof *rows && status == GW_OK; i++)
		status = check_number(rows[i].name, rows[i].value, rows[i].low, rows[i].high, error);
	if (status == GW_OK && b->points->count == 0)
		status = gw_fail(error, GW_ERROR_DATA,
						 "the cloud holds no points, so there is nothing to light");
	if (status == GW_OK && refines(o) && o->estimate_points == 0)
		status = gw_fail(error, GW_ERROR_USAGE,
						 "an error or a time to aim at needs an estimate of the error; let it have "
						 "at least one point");
	return status == GW_OK ? gw_lights_check(b->lights, b->light_count, error) : status;
}

static gw_status make_surfels(bake *b, gw_error *error)
{
	gw_surfels_options options = { .threads = b->options.threads,
								   .lights = b->lights,
								   .light_count = b->light_count,
								   .memory = b->options.memory,
								   .cancelled = cancelled,
								   .user = b };
	gw_status status = gw_surfels_make(b->points, &options, &b->surfels, error);
	if (status != GW_OK)
		return status;
	const gw_surfels *s = &b->surfels;
	gw_report *r = b->report;
	gw_report_count(r, "left_out_non_finite", s->non_finite,
					"points without finite coordinates: left out, written as dark");
	gw_report_count(r, "duplicates_merged", s->duplicates,
					"points at the place of another: they share its light");
	gw_report_count(r, "albedo_clamped", s->albedo_clamped,
					"points whose albedo was outside 0 to 0.98");
	gw_report_count(r, "albedo_defaulted", s->albedo_defaulted,
					"points whose albedo was not a number: 0.5 was taken");
	gw_report_count(r, "emission_repaired", s->emission_repaired,
					"points with negative or non-finite emission: taken as 0");
	gw_report_count(r, "normals_estimated", s->normals_estimated,
					"points whose normal was missing or bad: estimated from neighbours");
	gw_report_count(r, "normals_untrusted", s->normals_untrusted,
					"points whose normal cannot be trusted: lit from both sides");
	memcpy(r->origin, s->origin, sizeof r->origin);
	r->spacing = (double)s->spacing;
	return GW_OK;
}

static gw_status open_device(bake *b, gw_error *error)
{
	gw_gpu_options options = { .device = b->options.device,
							   .memory = b->options.memory,
							   .validate = b->options.validate };
	gw_status status = gw_gpu_create(&options, &b->gpu, error);
	if (status == GW_OK) {
		const gw_device_info *device = gw_gpu_device(b->gpu);
		snprintf(b->report->device, sizeof b->report->device, "%s", device->name);
		snprintf(b->report->driver, sizeof b->report->driver, "%s", device->driver);
	}
	return status;
}

static gw_status build_octree(bake *b, gw_error *error)
{
	const gw_bake_options *o = &b->options;
	b->octree_start = gw_seconds();
	gw_status status =
		o->depth == GW_DEPTH_AUTO
			? gw_octree_build_spaced(b->gpu, &b->surfels, o->leaf_spacing, &b->octree, error)
			: gw_octree_build(b->gpu, &b->surfels, o->depth, &b->octree, error);
	if (status != GW_OK)
		return status;
	gw_passes_init(&b->passes, b->gpu, &b->octree);
	gw_report *r = b->report;
	r->depth = b->octree.depth;
	r->leaf_size = (double)b->octree.leaf_size;
	r->leaves = b->octree.leaf_count;
	r->tiles = b->octree.tile_count;
	r->leaf_tiles = b->octree.leaf_tile_count;
	r->border_tiles = b->octree.border_tile_count;
	r->octree_bytes = gw_gpu_read_account(b->gpu).bytes;
	return GW_OK;
}

static gw_status texel4(bake *b, uint64_t count, const char *name, gw_buffer *buffer,
						gw_error *error)
{
	return gw_buffer_create(b->gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT, 16 * count,
							name, buffer, error);
}

static gw_status light_directly(bake *b, gw_error *error)
{
	uint64_t slots = 2 * (uint64_t)b->octree.leaf_count;
	gw_status status = texel4(b, b->surfels.count, "direct irradiance", &b->surfel_direct, error);
	if (status == GW_OK)
		status = texel4(b, slots, "lobe direct irradiance", &b->lobe_direct, error);
	if (status == GW_OK && b->plan.lamps)
		status = gw_direct_light(&b->passes, &b->octree, &b->surfels, b->lights, b->light_count,
								 &b->options, &b->surfel_direct, &b->lobe_direct, error);
	b->octree_seconds = gw_seconds() - b->octree_start;
	return status;
}

/* ------------------------------------------------------------------ what the trace steps do */

static gw_status gather_by_rays(void *self, const gw_buffer *lobe_radiance, float largest,
								gw_error *error)
{
	bake *b = self;
	(void)largest;
	return gw_ray_gather_bounce(&b->passes, &b->rays, lobe_radiance, &b->records, error);
}

/* What lamps and emitters light is sampled like an emitter: rays would miss small bright patches.
 */
static gw_status gather_patches(void *self, const gw_buffer *lobe_radiance, float largest,
								gw_error *error)
{
	bake *b = self;
	const float black[3] = { 0 };
	gw_emitters patches;
	gw_status status = gw_emitters_make(b->gpu, &b->octree, lobe_radiance, &patches, error);
	if (status == GW_OK && !gw_emitters_are_small(&patches))
		status = gather_by_rays(b, lobe_radiance, largest, error);
	else if (status == GW_OK) {
		const gw_sampled_sources sources = { .emitters = &patches,
											 .samples = b->options.light_samples,
											 .use_hits = true,
											 .sky = black,
											 .seed = (uint32_t)b->options.seed ^ PATCH_SEED };
		status = gw_ray_gather_sampled(&b->passes, &b->octree, &b->records, &b->rays, &sources,
									   &b->records.gathered, error);
	}
	gw_emitters_destroy(b->gpu, &patches);
	return status;
}

static gw_status gather_by_cones(void *self, const gw_buffer *lobe_radiance, float largest,
								 gw_error *error)
{
	bake *b = self;
	const float black[3] = { 0 };
	return gw_cone_gather_bounce(&b->passes, &b->octree, &b->cones, &b->records, lobe_radiance,
								 largest, black, &b->records.gathered, error);
}

static gw_status first_by_rays(bake *b, gw_error *error)
{
	gw_status status = gw_ray_gather_trace(&b->passes, &b->octree, &b->records, b->options.rays,
										   (uint32_t)b->options.seed, &b->rays, error);
	if (status == GW_OK)
		status = gw_ray_gather_sampled(&b->passes, &b->octree, &b->records, &b->rays,
									   &(gw_sampled_sources){ .emitters = &b->emitters,
															  .samples = b->options.light_samples,
															  .use_hits = true,
															  .sky = b->plan.sky_radiance,
															  .seed = (uint32_t)b->options.seed },
									   &b->records.first, error);
	return status;
}

static float largest_emission(const gw_surfels *surfels)
{
	float largest = 0.0f;
	for (size_t i = 0; i < 3 * surfels->count; i++)
		largest = fmaxf(largest, surfels->emission[i]);
	return largest;
}

/* Cones see the sky and large emitters; small emitters are sampled, with a few rays that also find
 * how near the records' surroundings are. */
static gw_status first_by_cones(bake *b, gw_error *error)
{
	const float black[3] = { 0 };
	bool in_voxels = b->plan.emitters && b->emitters.area_share >= SAMPLED_SHARE;
	uint32_t samples = in_voxels ? 0 : b->options.light_samples;
	gw_ray_gather nearest = { 0 };
	gw_status status = gw_ray_gather_trace(&b->passes, &b->octree, &b->records, NEAREST_RAYS,
										   (uint32_t)b->options.seed, &nearest, error);
	if (status == GW_OK)
		status = gw_ray_gather_sampled(&b->passes, &b->octree, &b->records, &nearest,
									   &(gw_sampled_sources){ .emitters = &b->emitters,
															  .samples = samples,
															  .sky = black,
															  .seed = (uint32_t)b->options.seed },
									   &b->records.first, error);
	gw_ray_gather_destroy(b->gpu, &nearest);
	if (status == GW_OK)
		status = gw_cone_gather_create(b->gpu, &b->octree, b->options.cones,
									   (uint32_t)b->options.seed, &b->cones, error);
	if (status != GW_OK || (!in_voxels && !b->plan.sky))
		return status;
	status = gw_cone_gather_bounce(&b->passes, &b->octree, &b->cones, &b->records,
								   in_voxels ? &b->octree.lobe_emission : &b->lobe_radiance,
								   in_voxels ? largest_emission(&b->surfels) : 1.0f,
								   b->plan.sky_radiance, &b->records.gathered, error);
	if (status == GW_OK) {
		const gw_binding bindings[] = { gw_window(&b->records.gathered, 16),
										gw_window(&b->records.first, 16) };
		status = gw_passes_run(&b->passes, GW_PASS_RECORD_ADD, bindings, (uint32_t[16]){ 0 },
							   b->records.count, error);
	}
	return status;
}

static gw_status place_records(bake *b, gw_error *error)
{
	uint64_t slots = 2 * (uint64_t)b->octree.leaf_count;
	gw_status status = texel4(b, slots, "lobe radiance", &b->lobe_radiance, error);
	b->round_start = gw_seconds();
	b->emitters.radiance = &b->octree.lobe_emission;
	if (status == GW_OK && b->plan.emitters)
		status =
			gw_emitters_make(b->gpu, &b->octree, &b->octree.lobe_emission, &b->emitters, error);
	if (status == GW_OK)
		status = gw_records_place(&b->passes, &b->octree, b->options.record_spacing,
								  b->options.seed, &b->records, error);
	b->report->records = b->records.count;
	return status;
}

static gw_status gather_first(bake *b, gw_error *error)
{
	gw_status status =
		b->options.method == GW_METHOD_RAYS ? first_by_rays(b, error) : first_by_cones(b, error);
	b->report->brick_bytes = b->cones.leaf_pool.allocated + b->cones.mip_pool.allocated;
	if (status == GW_OK)
		status = gw_records_weigh_lobes(&b->passes, &b->octree, &b->records, error);
	return status;
}

static gw_status bounce(bake *b, gw_error *error)
{
	bool rays = b->options.method == GW_METHOD_RAYS;
	gw_bounces bounces;
	gw_bounces_task task = { .passes = &b->passes,
							 .octree = &b->octree,
							 .records = &b->records,
							 .lobe_direct = &b->lobe_direct,
							 .lobe_radiance = &b->lobe_radiance,
							 .step = { .gather = rays ? gather_by_rays : gather_by_cones,
									   .gather_first = rays ? gather_patches : NULL,
									   .self = b },
							 .limit = b->plan.bounces ? b->plan.limit : 1,
							 .tolerance = b->options.tolerance,
							 .cancelled = cancelled,
							 .user = b };
	gw_status status = gw_bounces_run(&task, &bounces, error);
	b->report->bounce = bounces.bounce;
	b->report->bounce_count = bounces.bounce_count;
	b->report->remaining = bounces.remaining;
	return status;
}

static gw_status read_back(bake *b, gw_error *error)
{
	uint64_t count = b->surfels.count;
	gw_status status = gw_buffer_create(b->gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 16 * count,
										"surfel first irradiance", &b->surfel_first, error);
	if (status == GW_OK)
		status = gw_buffer_create(b->gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 16 * count,
								  "surfel indirect irradiance", &b->surfel_indirect, error);
	if (status == GW_OK)
		status = gw_records_read_back(&b->passes, &b->octree, &b->records, count, &b->surfel_first,
									  &b->surfel_indirect, error);
	return status;
}

static gw_status download(bake *b, gw_buffer *buffer, float **values, gw_error *error);

static uint32_t samples_of(const gw_bake_options *o)
{
	return o->method == GW_METHOD_RAYS ? o->rays : o->light_samples;
}

static gw_status estimate(bake *b, gw_error *error)
{
	float *direct = NULL, *first = NULL, *indirect = NULL;
	gw_status status = download(b, &b->surfel_direct, &direct, error);
	if (status == GW_OK)
		status = download(b, &b->surfel_first, &first, error);
	if (status == GW_OK)
		status = download(b, &b->surfel_indirect, &indirect, error);
	if (status == GW_OK) {
		const gw_estimate_task task = { .passes = &b->passes,
										.octree = &b->octree,
										.surfels = &b->surfels,
										.records = &b->records,
										.emitters = &b->emitters,
										.lobe_direct = &b->lobe_direct,
										.sky = b->plan.sky_radiance,
										.bounces = b->plan.bounces,
										.direct = direct,
										.first = first,
										.indirect = indirect,
										.rays = samples_of(&b->options),
										.light_samples = b->options.light_samples,
										.points = b->options.estimate_points,
										.seed = (uint32_t)b->options.seed };
		status = gw_estimate_error(&task, &b->report->error, error);
	}
	free(direct);
	free(first);
	free(indirect);
	return status;
}

/* ------------------------------------------------------------------------------------ result */

static gw_status allocate_result(size_t count, gw_bake_result *result, gw_error *error)
{
	result->count = count;
	float **vectors[] = { &result->radiance, &result->direct_irradiance,
						  &result->indirect_irradiance, &result->normal, &result->albedo };
	bool complete = (result->roi = gw_allocate_zeros(count, sizeof(float))) != NULL;
	for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
		complete &= (*vectors[i] = gw_allocate_zeros(count, 3 * sizeof(float))) != NULL;
	if (!complete)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for the light of %zu points", count);
	return GW_OK;
}

/* Downloads a vec4 buffer; NULL in *values when the buffer was never made. */
static gw_status download(bake *b, gw_buffer *buffer, float **values, gw_error *error)
{
	if (buffer->handle == VK_NULL_HANDLE)
		return GW_OK;
	*values = gw_allocate_array(b->surfels.count, 4 * sizeof **values);
	if (!*values)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for the light of %zu surfels",
					   b->surfels.count);
	return gw_buffer_download(b->gpu, buffer, 0, *values, 16 * (uint64_t)b->surfels.count, error);
}

typedef struct scatter {
	const bake *b;
	const float *direct, *first, *indirect; /* 4 a surfel, or NULL */
} scatter;

static float component(const float *values, size_t surfel, size_t c)
{
	return values ? values[4 * surfel + c] : 0.0f;
}

/* L = Le + rho / pi * E for the points first..last-1. */
static void scatter_points(void *user, size_t first, size_t last, uint32_t worker)
{
	const scatter *job = user;
	const gw_surfels *surfels = &job->b->surfels;
	gw_bake_result *out = job->b->result;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint32_t s = surfels->surfel_of_point[i];
		if (s == UINT32_MAX)
			continue;
		out->roi[i] = fminf(1.0f, surfels->nearest[s] / job->b->octree.leaf_size);
		for (size_t c = 0; c < 3; c++) {
			float direct = component(job->direct, s, c) + component(job->first, s, c);
			float indirect = component(job->indirect, s, c);
			float albedo = surfels->albedo[3 * s + c];
			float emission = surfels->emission ? surfels->emission[3 * s + c] : 0.0f;
			out->direct_irradiance[3 * i + c] = direct;
			out->indirect_irradiance[3 * i + c] = indirect;
			out->albedo[3 * i + c] = albedo;
			out->normal[3 * i + c] =
				(surfels->lamp_normal ? surfels->lamp_normal : surfels->normal)[3 * s + c];
			out->radiance[3 * i + c] = emission + albedo * 0.318309886f * (direct + indirect);
		}
	}
}

static gw_status collect(bake *b, gw_error *error)
{
	float *direct = NULL, *first = NULL, *indirect = NULL;
	gw_status status = allocate_result(b->points->count, b->result, error);
	if (status == GW_OK)
		status = download(b, &b->surfel_direct, &direct, error);
	if (status == GW_OK)
		status = download(b, &b->surfel_first, &first, error);
	if (status == GW_OK)
		status = download(b, &b->surfel_indirect, &indirect, error);
	if (status == GW_OK) {
		uint64_t lost = 0;
		for (size_t i = 0; first != NULL && i < b->surfels.count; i++)
			lost += !(first[4 * i + 3] > 0.0f);
		gw_report_count(b->report, "without_record", lost,
						"points with no record near: no gathered light");
		scatter job = { b, direct, first, indirect };
		gw_parallel_for(gw_thread_count(b->options.threads), b->points->count, 65536,
						scatter_points, &job);
	}
	free(direct);
	free(first);
	free(indirect);
	return status;
}

static gw_status collect_voxels(bake *b, gw_error *error)
{
	gw_voxels_task task = { .passes = &b->passes,
							.octree = &b->octree,
							.surfels = &b->surfels,
							.records = b->plan.records ? &b->records : NULL,
							.lobe_direct = &b->lobe_direct };
	return gw_voxels_collect(&task, &b->result->voxels, error);
}

/* -------------------------------------------------------------------------------------- steps */

typedef struct step {
	const char *name;
	double share; /* of the whole, for progress: what was measured on a 1.4 M point cave */
	gw_status (*run)(bake *b, gw_error *error);
	bool (*wanted)(const bake *b);
} step;

static bool always(const bake *b)
{
	(void)b;
	return true;
}

static bool needs_records(const bake *b)
{
	return b->plan.records;
}

static bool needs_estimate(const bake *b)
{
	return b->plan.records && b->options.estimate_points > 0;
}

static bool needs_voxels(const bake *b)
{
	return b->options.voxels;
}

static gw_status make_plan(bake *b, gw_error *error)
{
	(void)error;
	gw_plan_make(&b->surfels, b->lights, b->light_count, &b->options, &b->plan, b->report);
	return GW_OK;
}

static const step steps[] = {
	{ "device", 0.01, open_device, always },
	{ "surfels", 0.35, make_surfels, always },
	{ "plan", 0.0, make_plan, always },
	{ "octree", 0.25, build_octree, always },
	{ "direct light", 0.1, light_directly, always },
	{ "records", 0.02, place_records, needs_records },
	{ "first gather", 0.12, gather_first, needs_records },
	{ "bounces", 0.05, bounce, needs_records },
	{ "read back", 0.08, read_back, needs_records },
	{ "estimate", 0.02, estimate, needs_estimate },
	{ "voxels", 0.02, collect_voxels, needs_voxels },
	{ "points", 0.02, collect, always },
};

/* Where in steps a round begins: with a new octree, or with new records; and what comes after. */
enum { OCTREE_STEP = 3, RECORDS_STEP = 5, AFTER_ROUND = 10, STEP_COUNT = 12 };

/* Runs the steps first to last - 1. */
static gw_status run_steps(bake *b, size_t first, size_t last, gw_error *error)
{
	double done = 0.0;
	gw_status status = GW_OK;
	for (size_t i = 0; i < last && status == GW_OK; i++) {
		if (i >= first && steps[i].wanted(b)) {
			status = stage(b, steps[i].name, b->refining ? fmax(done, 0.9) : done, error);
			if (status == GW_OK)
				status = steps[i].run(b, error);
		}
		done += steps[i].share;
	}
	return status;
}

/* ------------------------------------------------------------------------------------ rounds */

static void drop_records(bake *b)
{
	gw_buffer_destroy(b->gpu, &b->surfel_first);
	gw_buffer_destroy(b->gpu, &b->surfel_indirect);
	gw_buffer_destroy(b->gpu, &b->lobe_radiance);
	gw_cone_gather_destroy(b->gpu, &b->cones);
	gw_ray_gather_destroy(b->gpu, &b->rays);
	gw_records_destroy(b->gpu, &b->records);
	gw_emitters_destroy(b->gpu, &b->emitters);
	memset(b->passes.device_seconds, 0, sizeof b->passes.device_seconds);
}

static void drop_octree(bake *b)
{
	drop_records(b);
	gw_buffer_destroy(b->gpu, &b->surfel_direct);
	gw_buffer_destroy(b->gpu, &b->lobe_direct);
	if (b->passes.gpu)
		gw_passes_destroy(&b->passes);
	gw_octree_destroy(b->gpu, &b->octree);
}

static void book_round(bake *b, double seconds, const char *why)
{
	const gw_bake_options *o = &b->options;
	gw_round *round = &b->report->round[b->report->round_count++];
	*round = (gw_round){ .record_spacing = o->record_spacing,
						 .leaf_spacing = o->leaf_spacing,
						 .rays = o->rays,
						 .light_samples = o->light_samples,
						 .cones = o->cones,
						 .error = b->report->error,
						 .seconds = seconds };
	snprintf(round->why, sizeof round->why, "%s", why);
}

/* Solves again; surfels stay, and the octree when its leaves do. */
static gw_status run_round(bake *b, const gw_bake_options *next, const char *why, gw_error *error)
{
	bool keep = next->leaf_spacing == b->options.leaf_spacing;
	double start = gw_seconds();
	b->options = *next;
	free(b->report->bounce);
	b->report->bounce = NULL;
	b->report->bounce_count = 0;
	if (keep)
		drop_records(b);
	else
		drop_octree(b);
	gw_status status = run_steps(b, keep ? RECORDS_STEP : OCTREE_STEP, AFTER_ROUND, error);
	if (status == GW_OK)
		book_round(b, gw_seconds() - start, why);
	return status;
}

/* Where finer settings found no memory, the result is that of the settings before. */
static gw_status refine_once(bake *b, const gw_bake_options *next, const char *why, gw_error *error)
{
	gw_bake_options last = b->options;
	gw_status status = run_round(b, next, why, error);
	if (status != GW_ERROR_MEMORY)
		return status;
	b->report->goal = GW_GOAL_MEMORY;
	b->options.leaf_spacing = 0.0f; /* whatever octree there is goes */
	return run_round(b, &last, "finer settings found no memory", error);
}

static gw_refine_answer choose_next(bake *b, gw_bake_options *next, char why[96])
{
	double now = gw_seconds(), limit = (double)b->options.time_limit;
	const gw_refine_state state = { .options = &b->options,
									.error = b->report->error,
									.round_seconds = now - b->round_start,
									.octree_seconds = b->octree_seconds,
									.seconds_left =
										limit > 0.0 ? b->start + limit - now : INFINITY };
	return gw_refine_next(&state, next, why);
}

/* Goes on until the target is reached, the time is up, or nothing is left to refine. */
static gw_status refine(bake *b, gw_error *error)
{
	gw_report *r = b->report;
	gw_status status = GW_OK;
	book_round(b, gw_seconds() - b->start, "the settings that were given");
	gw_report_stage(r, b->gpu, "refining");
	b->refining = true;
	while (status == GW_OK && r->goal == GW_GOAL_NONE) {
		char why[96];
		gw_bake_options next;
		gw_refine_answer answer = GW_REFINE_EXHAUSTED;
		/* One place is kept for going back. */
		if (r->error.points > 0 && r->round_count < GW_REPORT_ROUNDS - 1)
			answer = choose_next(b, &next, why);
		if (!b->plan.records || gw_refine_reached(&b->options, &r->error))
			r->goal = GW_GOAL_REACHED;
		else if (answer == GW_REFINE_NO_TIME)
			r->goal = GW_GOAL_TIME;
		else if (answer == GW_REFINE_EXHAUSTED)
			r->goal = GW_GOAL_EXHAUSTED;
		else
			status = refine_once(b, &next, why, error);
	}
	r->missed = b->options.max_error > 0.0f && b->plan.records &&
				!gw_refine_reached(&b->options, &r->error);
	b->refining = false;
	return status;
}

static gw_status check_validation(const bake *b, gw_error *error)
{
	const char *first;
	uint32_t messages = gw_gpu_validation_messages(b->gpu, &first);
	if (messages > 0)
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "the validation layer objected %u times, first: %.600s", messages, first);
	return GW_OK;
}

/* What the bounces cost, in the terms of Salm's tables 5.1 to 5.4. */
static void report_profile(const gw_passes *passes, gw_report *report)
{
	const double *seconds = passes->device_seconds;
	report->inject_seconds =
		seconds[GW_PASS_LOBE_SHADE] + seconds[GW_PASS_BRICK_INJECT] + seconds[GW_PASS_BRICK_MIPMAP];
	report->trace_seconds = seconds[GW_PASS_RECORD_RAYS] + seconds[GW_PASS_RECORD_EMITTERS] +
							seconds[GW_PASS_RECORD_FIRST];
	report->gather_seconds = seconds[GW_PASS_RECORD_GATHER] + seconds[GW_PASS_RECORD_CONES];
}

static gw_status run(bake *b, gw_error *error)
{
	gw_status status = check_options(b, error);
	if (status == GW_OK)
		status = run_steps(b, 0, AFTER_ROUND, error);
	if (status == GW_OK && refines(&b->options))
		status = refine(b, error);
	if (status == GW_OK)
		status = run_steps(b, AFTER_ROUND, STEP_COUNT, error);
	gw_report_stage(b->report, b->gpu, NULL);
	report_profile(&b->passes, b->report);
	if (b->gpu)
		b->report->peak_bytes = gw_gpu_read_account(b->gpu).peak_bytes;
	if (status == GW_OK && b->options.validate)
		status = check_validation(b, error);
	return status;
}

static void release(bake *b)
{
	gw_surfels_clear(&b->surfels);
	if (b->gpu == NULL)
		return;
	drop_octree(b);
	gw_gpu_destroy(&b->gpu);
}

gw_status gw_bake(const gw_points *points, const gw_light *lights, size_t light_count,
				  const gw_bake_options *options, const gw_bake_callbacks *callbacks,
				  gw_bake_result **result, gw_error *error)
{
	*result = NULL;
	bake b = {
		.points = points, .lights = lights, .light_count = light_count, .options = *options
	};
	if (callbacks)
		b.callbacks = *callbacks;
	b.result = gw_allocate_zeros(1, sizeof *b.result);
	if (!b.result)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for a result");
	b.report = &b.result->report;
	b.start = gw_seconds();
	gw_status status = run(&b, error);
	release(&b);
	if (status == GW_OK)
		*result = b.result;
	else
		gw_bake_result_destroy(&b.result);
	return status;
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
	free(r->roi);
	gw_voxels_clear(&r->voxels);
	free(r->report.bounce);
	free(r);
	*result = NULL;
}
