/*
 * solver.c - see solver.h.
 */
#include "bake/solver.h"

#include "light/direct_light.h"
#include "base/memory.h"
#include "bake/report.h"
#include "surfels/surfel_steps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rays a record that only look for the nearest surface, when cones gather. */
#define NEAREST_RAYS 16u

static gw_status check_number(const char *option, double value, double low, double high,
							  gw_error *error)
{
	if (!(value >= low && value <= high))
		return gw_fail(error, GW_ERROR_USAGE, "%s is %g; give a number from %g to %g", option,
					   value, low, high);
	return GW_OK;
}

bool gw_options_refine(const gw_bake_options *o)
{
	return o->max_error > 0.0f || o->time_limit > 0.0f;
}

gw_status gw_options_check(const gw_bake_options *o, size_t point_count, const gw_light *lights,
						   size_t light_count, gw_error *error)
{
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
		{ "occlusion distance", (double)o->occlusion_distance, 0, 1e9 },
		{ "time limit", (double)o->time_limit, 0, 1e9 },
		{ "method", (double)o->method, 0, GW_METHOD_COUNT - 1 },
		{ "shadows", (double)o->shadows, 0, GW_SHADOWS_COUNT - 1 },
		{ "passes", (double)o->passes, 0, GW_PASSES_COUNT - 1 },
		{ "validation", (double)o->validate, 0, GW_VALIDATION_COUNT - 1 },
	};
	gw_status status = GW_OK;
	for (size_t i = 0; i < sizeof rows / sizeof *rows && status == GW_OK; i++)
		status = check_number(rows[i].name, rows[i].value, rows[i].low, rows[i].high, error);
	if (status == GW_OK && point_count == 0)
		status = gw_fail(error, GW_ERROR_DATA,
						 "the cloud holds no points, so there is nothing to light");
	if (status == GW_OK && gw_options_refine(o) && o->estimate_points == 0)
		status = gw_fail(error, GW_ERROR_USAGE,
						 "an error or a time to aim at needs an estimate of the error; let it have "
						 "at least one point");
	if (status == GW_OK && gw_options_refine(o) && o->transport)
		status = gw_fail(error, GW_ERROR_USAGE,
						 "a bake that refines its settings cannot begin with a transport nor make "
						 "one; leave out the error or time to aim at");
	return status == GW_OK ? gw_lights_check(lights, light_count, error) : status;
}

gw_status gw_solver_open_device(gw_solver *solver, gw_error *error)
{
	gw_gpu_options options = { .device = solver->options.device,
							   .memory = solver->options.memory,
							   .drivers = solver->options.drivers,
							   .validate = solver->options.validate != GW_VALIDATE_NOTHING,
							   .validate_synchronization =
								   solver->options.validate == GW_VALIDATE_CALLS,
							   .validate_gpu_assisted =
								   solver->options.validate == GW_VALIDATE_ACCESSES,
							   .passes = solver->options.passes,
							   .cancelled = solver->cancelled,
							   .user = solver->user };
	gw_status status = gw_gpu_create(&options, &solver->gpu, error);
	if (status == GW_OK) {
		const gw_device_info *device = gw_gpu_device(solver->gpu);
		snprintf(solver->report->device, sizeof solver->report->device, "%s", device->name);
		snprintf(solver->report->driver, sizeof solver->report->driver, "%s", device->driver);
	}
	return status;
}

/* Of those that are left out. */
static uint64_t count_far(const gw_points *points)
{
	uint64_t far = 0;
	for (size_t i = 0; i < points->count; i++) {
		const double *p = points->position + 3 * i;
		double most = fmax(fmax(fabs(p[0]), fabs(p[1])), fabs(p[2]));
		far += isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) && most > GW_COORDINATE_MAX;
	}
	return far;
}

void gw_report_surfels(gw_report *r, const gw_surfels *s, const gw_points *points)
{
	uint64_t far = s->non_finite > 0 ? count_far(points) : 0;
	gw_report_count(r, "left_out_non_finite", s->non_finite - far,
					"points without finite coordinates: left out, written as dark");
	gw_report_count(r, "left_out_far", far,
					"points with a coordinate beyond 1e12 m: left out, written as dark");
	char meaning[sizeof r->count->meaning];
	snprintf(
		meaning, sizeof meaning,
		"points far off all others, up to %.3g m: strays, which neither shade nor light the rest",
		(double)s->stray_distance);
	gw_report_count(r, "strays", s->strays, meaning);
	gw_report_count(r, "duplicates_merged", s->duplicates,
					"points at the place of another: they share its light");
	gw_report_count(r, "albedo_clamped", s->albedo_clamped,
					"points whose albedo was outside 0 to 0.99");
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
}

gw_status gw_solver_make_surfels(gw_solver *solver, const gw_points *points, const gw_light *lights,
								 size_t light_count, gw_error *error)
{
	gw_surfels_options options = { .threads = solver->options.threads,
								   .lights = lights,
								   .light_count = light_count,
								   .memory = solver->options.memory,
								   .cancelled = solver->cancelled,
								   .user = solver->user };
	gw_status status = gw_surfels_make(points, &options, &solver->surfels, error);
	if (status == GW_OK)
		gw_report_surfels(solver->report, &solver->surfels, points);
	return status;
}

void gw_solver_report_octree(const gw_solver *solver)
{
	const gw_octree *octree = &solver->octree;
	gw_report *r = solver->report;
	r->records = solver->records.count;
	r->depth = octree->depth;
	r->leaf_size = (double)octree->leaf_size;
	r->wanted_leaf_size = (double)octree->wanted_leaf_size;
	snprintf(r->why_coarser, sizeof r->why_coarser, "%s", octree->why_coarser);
	r->leaves = octree->leaf_count;
	r->tiles = octree->tile_count;
	r->leaf_tiles = octree->leaf_tile_count;
	r->border_tiles = octree->border_tile_count;
	r->octree_bytes = gw_gpu_read_account(solver->gpu).bytes;
}

static uint32_t ray_count(const gw_bake_options *o)
{
	return o->method == GW_METHOD_RAYS ? o->rays : NEAREST_RAYS;
}

gw_status gw_solver_build_octree(gw_solver *solver, gw_error *error)
{
	const gw_bake_options *o = &solver->options;
	gw_status status =
		solver->keeps
			? gw_octree_build_kept(solver->gpu, &solver->surfels, solver->still, o->depth,
								   o->leaf_spacing, &solver->kept_octree, &solver->octree, error)
		: o->depth == GW_DEPTH_AUTO
			? gw_octree_build_spaced(solver->gpu, &solver->surfels, o->leaf_spacing,
									 &solver->octree, error)
			: gw_octree_build(solver->gpu, &solver->surfels, o->depth, &solver->octree, error);
	if (status != GW_OK)
		return status;
	/* Octrees that keep what they can are all of one shape, but for large discs. */
	if (solver->passes.gpu != NULL && !gw_octree_passes_fit(&solver->passes, &solver->octree))
		gw_passes_destroy(&solver->passes);
	if (solver->passes.gpu == NULL)
		gw_octree_passes(&solver->passes, solver->gpu, &solver->octree);
	solver->passes.threads = o->threads;
	gw_solver_report_octree(solver);
	if (o->method == GW_METHOD_CONES)
		gw_report_count(
			solver->report, "cones_pass", solver->octree.tree_discs,
			"points sparser than cones can see: light leaks between them; use rays, or a "
			"larger leaf spacing or less depth");
	return GW_OK;
}

static void report_rays(gw_solver *solver)
{
	gw_report *r = solver->report;
	r->rays = (uint64_t)solver->rays.rays * solver->records.count;
	r->rays_traced = solver->kept ? solver->traced : r->rays;
}

/* What the records see; for cones, how near their surroundings are. */
static gw_status trace_records(gw_solver *solver, gw_error *error)
{
	const gw_bake_options *o = &solver->options;
	gw_status status;
	if (solver->kept)
		status = gw_kept_hits_trace(&solver->passes, &solver->octree, &solver->records,
									solver->kept, solver->box, solver->box_count, &solver->rays,
									&solver->traced, error);
	else
		status = gw_ray_gather_trace(&solver->passes, &solver->octree, &solver->records,
									 ray_count(o), (uint32_t)o->seed, &solver->rays, error);
	report_rays(solver);
	if (status == GW_OK)
		status = gw_ray_gather_look(&solver->passes, &solver->octree, &solver->records,
									&solver->rays, error);
	return status;
}

/* Work space of cones. */
static gw_status make_pools(gw_solver *solver, gw_error *error)
{
	const gw_bake_options *o = &solver->options;
	if (o->method != GW_METHOD_CONES)
		return GW_OK;
	gw_status status = gw_cone_gather_create(solver->gpu, &solver->octree, o->cones,
											 (uint32_t)o->seed, &solver->cones, error);
	solver->report->brick_bytes =
		solver->cones.leaf_pool.allocated + solver->cones.mip_pool.allocated;
	return status;
}

/* What emitters brought is not so any more. */
void gw_solver_forget_further(gw_solver *solver)
{
	gw_records_destroy(solver->gpu, &solver->further);
	gw_ray_gather_destroy(solver->gpu, &solver->further_rays);
}

void gw_solver_forget_samples(gw_solver *solver)
{
	gw_buffer_destroy(solver->gpu, &solver->sampled);
	gw_probe_hits_forget_emitted(&solver->probed);
	gw_solver_forget_further(solver);
}

gw_status gw_solver_place_records(gw_solver *solver, gw_error *error)
{
	const gw_bake_options *o = &solver->options;
	gw_status status = gw_records_place(&solver->passes, &solver->octree, o->record_spacing,
										o->seed, &solver->records, error);
	solver->report->records = solver->records.count;
	if (status == GW_OK)
		status = trace_records(solver, error);
	if (status == GW_OK)
		status = make_pools(solver, error);
	if (status == GW_OK)
		status =
			gw_records_weigh_lobes(&solver->passes, &solver->octree, &solver->records, NULL, error);
	if (status == GW_OK)
		status = gw_read_back_make(&solver->passes, &solver->octree, &solver->records,
								   solver->surfels.count, &solver->read_back, error);
	return status;
}

/* The records from `first` on, by themselves. */
static gw_status list_further(gw_solver *solver, uint32_t first, gw_error *error)
{
	gw_records *all = &solver->records;
	size_t count = all->count - first;
	float *rows = gw_allocate_array(count, 8 * sizeof *rows);
	if (!rows)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu records", count);
	gw_status status = gw_buffer_download(solver->gpu, &all->position, 16 * (uint64_t)first, rows,
										  16 * count, error);
	if (status == GW_OK)
		status = gw_buffer_download(solver->gpu, &all->normal, 16 * (uint64_t)first,
									rows + 4 * count, 16 * count, error);
	if (status == GW_OK)
		status = gw_records_put(solver->gpu, rows, rows + 4 * count, (uint32_t)count,
								&solver->further, error);
	free(rows);
	return status;
}

/* Which records light what, where they have come closer. */
static gw_status weigh_again(gw_solver *s, const gw_record_density *density, gw_error *error)
{
	gw_buffer lobes = { 0 }, surfels = { 0 };
	gw_status status =
		gw_records_reach(s->gpu, &s->records, GW_LOBE_REACH, density->lobe_spacing,
						 density->lobe_closer, 2 * (size_t)s->octree.leaf_count, &lobes, error);
	if (status == GW_OK)
		status = gw_records_reach(s->gpu, &s->records, GW_SURFEL_REACH, density->surfel_spacing,
								  density->surfel_closer, s->surfels.count, &surfels, error);
	if (status == GW_OK)
		status = gw_records_weigh_lobes(&s->passes, &s->octree, &s->records, &lobes, error);
	if (status == GW_OK)
		status = gw_read_back_again(&s->passes, &s->octree, &s->records, &surfels,
									density->surfel_closer, &s->read_back, error);
	gw_buffer_destroy(s->gpu, &lobes);
	gw_buffer_destroy(s->gpu, &surfels);
	return status;
}

gw_status gw_solver_add_records(gw_solver *solver, const gw_record_density *density,
								gw_error *error)
{
	const gw_bake_options *o = &solver->options;
	uint32_t before = solver->records.count;
	gw_solver_forget_further(solver);
	gw_status status = gw_records_add(&solver->passes, &solver->octree, o->record_spacing, o->seed,
									  density->lobe_spacing, &solver->records, error);
	solver->report->records = solver->records.count;
	if (status == GW_OK && solver->records.count > before)
		status = list_further(solver, before, error);
	if (status == GW_OK && solver->further.count > 0)
		status = gw_ray_gather_add(&solver->passes, &solver->octree, &solver->further,
								   &solver->rays, &solver->further_rays, error);
	report_rays(solver);
	if (status == GW_OK)
		status = gw_ray_gather_look(&solver->passes, &solver->octree, &solver->records,
									&solver->rays, error);
	return status == GW_OK ? weigh_again(solver, density, error) : status;
}

gw_status gw_solver_open_to_sky(gw_solver *s, gw_error *error)
{
	gw_status status = GW_OK;
	if (!s->openings.looked)
		status =
			gw_openings_find(&s->passes, &s->octree, &s->records, &s->rays, &s->openings, error);
	if (status == GW_OK && s->further.count > 0)
		status = gw_ray_gather_open_further(&s->passes, &s->octree, &s->further, &s->openings,
											&s->rays, &s->further_rays, error);
	return status == GW_OK ? gw_ray_gather_open(&s->passes, &s->octree, &s->records, &s->openings,
												&s->rays, error)
						   : status;
}

gw_status gw_solver_complete(gw_solver *solver, const gw_points *points, gw_error *error)
{
	gw_report_surfels(solver->report, &solver->surfels, points);
	gw_solver_report_octree(solver);
	solver->report->records = solver->records.count;
	gw_status status = gw_records_make_room(solver->gpu, &solver->records, error);
	return status == GW_OK ? make_pools(solver, error) : status;
}

gw_status gw_solver_keep_hits(gw_solver *solver, gw_kept_hits *kept, gw_error *error)
{
	const gw_bake_options *o = &solver->options;
	gw_status status = gw_records_place(&solver->passes, &solver->octree, o->record_spacing,
										o->seed, &solver->records, error);
	if (status == GW_OK)
		status = gw_ray_gather_trace(&solver->passes, &solver->octree, &solver->records,
									 ray_count(o), (uint32_t)o->seed, &solver->rays, error);
	if (status == GW_OK)
		status = gw_kept_hits_take(solver->gpu, &solver->octree, &solver->records, &solver->rays,
								   kept, error);
	gw_solver_drop_records(solver);
	return status;
}

void gw_solver_drop_records(gw_solver *solver)
{
	gw_cone_gather_destroy(solver->gpu, &solver->cones);
	gw_ray_gather_destroy(solver->gpu, &solver->rays);
	gw_openings_destroy(solver->gpu, &solver->openings);
	gw_records_destroy(solver->gpu, &solver->records);
	gw_solver_forget_further(solver);
	gw_read_back_clear(&solver->read_back);
	gw_buffer_destroy(solver->gpu, &solver->sampled);
	gw_probe_hits_clear(&solver->probed);
	memset(solver->passes.device_seconds, 0, sizeof solver->passes.device_seconds);
}

void gw_solver_drop_octree(gw_solver *solver)
{
	gw_solver_drop_records(solver);
	if (solver->passes.gpu)
		gw_passes_destroy(&solver->passes);
	solver->passes = (gw_passes){ 0 };
	gw_octree_destroy(solver->gpu, &solver->octree);
}

void gw_solver_close(gw_solver *solver)
{
	gw_surfels_clear(&solver->surfels);
	if (solver->gpu == NULL)
		return;
	gw_solver_drop_octree(solver);
	gw_octree_kept_destroy(solver->gpu, &solver->kept_octree);
	gw_gpu_destroy(&solver->gpu);
}
