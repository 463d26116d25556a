/*
 * scene.c - see scene.h.
 */
#include "bake/scene.h"

#include "light/direct_light.h"
#include "glowworm_host.h"
#include "base/memory.h"
#include "base/nth_element.h"
#include "octree/compartments.h"
#include "bake/options_check.h"
#include "bake/report.h"
#include "cloud/strays.h"
#include "cloud/frame.h"
#include "surfels/surfel_parts.h"
#include "surfels/surface_holes.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Seconds between two questions whether to stop. */
#define ASKED_EVERY 0.1

gw_status gw_scene_begin(gw_scene *scene, const char *name, double done, double share,
						 gw_error *error)
{
	const gw_bake_callbacks *call = &scene->callbacks;
	gw_scene_stage *stage = &scene->stage;
	double now = gw_seconds();
	*stage = (gw_scene_stage){ name, done,          share, now, done > 0.0 ? stage->begun : now,
							   now,  stage->stopped };
	if (call->progress)
		call->progress(call->user, name, done);
	stage->stopped = stage->stopped || (call->cancelled && call->cancelled(call->user));
	return stage->stopped ? gw_fail(error, GW_ERROR_CANCELLED,
									"the bake was stopped before its stage '%s'", name)
						  : GW_OK;
}

gw_status gw_scene_check_validation(const gw_scene *scene, gw_error *error)
{
	const char *first;
	uint32_t messages =
		scene->options.validate ? gw_gpu_validation_messages(scene->gpu, &first) : 0;
	return messages > 0
			   ? gw_fail(error, GW_ERROR_INTERNAL,
						 "the validation layer objected %u times, first: %.600s", messages, first)
			   : GW_OK;
}

/*
 * How far the work is within its stage, by the clock: half when the stage has taken as long as it
 * should, going by the stages before, and never all. Nobody knows better: how long a stage takes
 * depends on how surfaces hide each other.
 */
static double done_of(const gw_scene_stage *stage, double now)
{
	double expected = stage->from > 0.0 ? (stage->start - stage->begun) / stage->from * stage->share
										: stage->share;
	double taken = now - stage->start;
	return stage->from + stage->share * (taken / (taken + expected + ASKED_EVERY));
}

bool gw_scene_stopped(void *user)
{
	gw_scene *scene = user;
	const gw_bake_callbacks *call = &scene->callbacks;
	gw_scene_stage *stage = &scene->stage;
	double now = gw_seconds();
	if (stage->stopped || stage->name == NULL || now - stage->asked < ASKED_EVERY)
		return stage->stopped;
	stage->asked = now;
	if (call->progress)
		call->progress(call->user, stage->name, done_of(stage, now));
	stage->stopped = call->cancelled && call->cancelled(call->user);
	return stage->stopped;
}

gw_status gw_scene_open_device(gw_scene *scene, gw_error *error)
{
	gw_gpu_options options = { .device = scene->options.device,
							   .memory = scene->options.memory,
							   .drivers = scene->options.drivers,
							   .validate = scene->options.validate != GW_VALIDATE_NOTHING,
							   .validate_synchronization =
								   scene->options.validate == GW_VALIDATE_CALLS,
							   .validate_gpu_assisted =
								   scene->options.validate == GW_VALIDATE_ACCESSES,
							   .passes = scene->options.passes,
							   .cancelled = gw_scene_stopped,
							   .user = scene };
	if (scene->lent && *scene->lent) {
		scene->gpu = *scene->lent;
		*scene->lent = NULL;
		gw_gpu_begin_again(scene->gpu, &options);
	} else {
		GW_TRY(gw_gpu_create(&options, &scene->gpu, error));
	}
	if (scene->lent)
		gw_gpu_keep_passes(scene->gpu);
	const gw_device_info *device = gw_gpu_device(scene->gpu);
	snprintf(scene->report->device, sizeof scene->report->device, "%s", device->name);
	snprintf(scene->report->driver, sizeof scene->report->driver, "%s", device->driver);
	return GW_OK;
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

/* How many strays there are of each kind, with an example each. */
static void report_strays(gw_report *r, const gw_surfels *s, const gw_points *points)
{
	char meaning[sizeof r->count->meaning + 64]; /* with what stands in braces */
	int length = snprintf(meaning, sizeof meaning,
						  "point{ is a stray|s are strays}, lit as the surface nearest to "
						  "{it|them}, of which {it is|they are} no part:");
	gw_strays_count(s, points, r->stray);
	for (int kind = 0; kind < GW_STRAY_KIND_COUNT; kind++) {
		const gw_stray_count *count = &r->stray[kind];
		if (count->points > 0 && length < (int)sizeof meaning)
			length += snprintf(
				meaning + length, sizeof meaning - (size_t)length, "%s %" PRIu64 " %s (%s, %s, %s)",
				meaning[length - 1] == ':' ? "" : ",", count->points,
				gw_stray_kind_name((gw_stray_kind)kind), GW_SAID_PLACE(count->position[0]),
				GW_SAID_PLACE(count->position[1]), GW_SAID_PLACE(count->position[2]));
	}
	gw_report_count(r, "strays", s->stray_count, meaning);
}

void gw_report_emission(gw_report *r, const gw_surfels *s)
{
	gw_report_count(r, "emission_repaired", s->emission_repaired,
					"point{|s} with negative or non-finite emission: taken as 0");
}

static uint64_t count_invisible(const gw_points *points)
{
	uint64_t invisible = 0;
	for (size_t i = 0; points->opacity && i < points->count; i++)
		invisible += !(points->opacity[i] > 0.0f);
	return invisible;
}

static uint64_t count_foliage(const gw_surfels *s)
{
	uint64_t foliage = 0;
	for (size_t i = 0; i < s->count; i++)
		foliage += s->two_sided[i] == GW_SIDE_FOLIAGE;
	return foliage;
}

/* How the points lie: how unevenly, and how many on surface that is narrow for them. */
static void report_sampling(gw_report *r, const gw_surfels *s)
{
	size_t few = s->count / 20, narrow = 0;
	r->spacing_ratio = fmax(r->spacing_ratio, 1.0);
	if (s->count == 0 || !s->radius || !s->clip) /* of stored transport, which has both numbers */
		return;
	float dense = gw_nth_element(s->radius, s->count, few);
	if (dense > 0.0f)
		r->spacing_ratio =
			(double)gw_nth_element(s->radius, s->count, s->count - 1 - few) / (double)dense;
	for (size_t i = 0; i < s->count; i++) {
		const float *c = s->clip + 6 * i;
		narrow += (c[0] != 0.0f || c[1] != 0.0f) && (c[3] != 0.0f || c[4] != 0.0f);
	}
	r->narrow_share = (double)narrow / (double)s->count;
}

void gw_report_surfels(gw_report *r, const gw_surfels *s, const gw_points *points)
{
	uint64_t far = s->non_finite > 0 ? count_far(points) : 0;
	uint64_t invisible = count_invisible(points);
	gw_report_count(r, "left_out_invisible", invisible,
					"point{|s} of opacity 0: left out, written as dark");
	gw_report_count(r, "left_out_non_finite", s->non_finite - far - invisible,
					"point{|s} without finite coordinates: left out, written as dark");
	gw_report_count(r, "left_out_far", far,
					"point{|s} with a coordinate beyond 1e12 m: left out, written as dark");
	report_strays(r, s, points);
	gw_report_count(
		r, "duplicates_merged", s->duplicates,
		"point{|s} at the place of another, or hardly off it: {it shares|they share} its "
		"light");
	gw_report_count(r, "albedo_clamped", s->albedo_clamped,
					"point{|s} whose albedo was outside 0 to 0.99");
	gw_report_count(r, "albedo_defaulted", s->albedo_defaulted,
					"point{|s} whose albedo was not a number: 0.5 was taken");
	gw_report_emission(r, s);
	gw_report_count(r, "normals_estimated", s->normals_estimated,
					"point{|s} whose normal was missing or bad: estimated from neighbours");
	gw_report_count(r, "normals_turned", s->normals_turned,
					"point{|s} whose normal faced the wrong side and was turned (--normals given "
					"leaves them)");
	gw_report_count(
		r, "normals_lengthened", s->normals_lengthened,
		"point{|s} whose normal was far too short for any surface: taken as of length 1 "
		"(--normals given leaves them)");
	gw_report_count(r, "normals_doubted", s->normals_doubted,
					"point{|s} whose normal came with so many wrong ones that all were estimated "
					"(--normals given takes them)");
	gw_report_count(r, "normals_untrusted", s->normals_untrusted,
					"point{|s} whose normal cannot be trusted: lit from both sides");
	gw_report_count(r, "foliage", count_foliage(s),
					"point{ fills|s fill} space as leaves do: light passes between them");
	memcpy(r->origin, s->origin, sizeof r->origin);
	r->spacing = (double)s->spacing;
	report_sampling(r, s);
}

void gw_scene_report_space(const gw_scene *scene)
{
	const gw_scanned_space *space = &scene->space;
	gw_gap_report *gaps = &scene->report->gaps;
	gaps->scanners = space->scanners;
	gaps->holes = space->holes;
	gaps->hole_width = (double)space->hole_width;
	for (int k = 0; k < 3; k++)
		gaps->hole_place[k] = scene->surfels.origin[k] + (double)space->hole_place[k];
}

gw_status gw_scene_find_space(gw_scene *scene, const gw_points *points, gw_error *error)
{
	const gw_bake_options *o = &scene->options;
	bool known = scene->space.state != NULL;
	if (gw_options_forbid(o, GW_EFFECT_GAPS)) {
		gw_scanned_space_clear(&scene->space);
		return GW_OK;
	}
	if (!known)
		GW_TRY(gw_scanned_space_make(points, &scene->surfels, o->threads, &scene->space, error));
	if (!known && scene->space.scanners == 0)
		GW_TRY(gw_surface_holes_find(&scene->surfels, o->threads, &scene->space, error));
	gw_scene_report_space(scene);
	return GW_OK;
}

gw_surfels_options gw_scene_surfels_options(gw_scene *scene, const gw_light *lights, size_t count)
{
	const gw_bake_options *o = &scene->options;
	return (gw_surfels_options){ .threads = o->threads,
								 .lights = lights,
								 .light_count = count,
								 .normals = o->normals,
								 .memory = o->memory,
								 .backs = true,
								 .effects_forced = o->effects_forced,
								 .effects_forbidden = o->effects_forbidden,
								 .cancelled = gw_scene_stopped,
								 .user = scene };
}

bool gw_scene_emission_is_alone(const gw_scene *scene)
{
	return gw_options_forbid(&scene->options, GW_EFFECT_EMITTERS) && !scene->options.voxels;
}

gw_status gw_scene_make_surfels(gw_scene *scene, const gw_scene_description *from, gw_error *error)
{
	const gw_surfels_options options =
		gw_scene_surfels_options(scene, from->lights, from->light_count);
	GW_TRY(gw_placed_surfels_make(from->points, &options, &scene->surfels, error));
	scene->surfels.emission_alone = gw_scene_emission_is_alone(scene);
	gw_report_surfels(scene->report, &scene->surfels, from->points);
	free(scene->surfels.normal_length); /* light has no use for it */
	scene->surfels.normal_length = NULL;
	return GW_OK;
}

void gw_scene_report_octree(const gw_scene *scene)
{
	const gw_octree *octree = &scene->octree;
	gw_report *r = scene->report;
	r->records = scene->records.count;
	r->depth = octree->depth;
	r->leaf_size = (double)octree->leaf_size;
	r->wanted_leaf_size = (double)octree->wanted_leaf_size;
	snprintf(r->why_coarser, sizeof r->why_coarser, "%s", octree->why_coarser);
	r->leaves = octree->leaf_count;
	r->tiles = octree->tile_count;
	r->leaf_tiles = octree->leaf_tile_count;
	r->border_tiles = octree->border_tile_count;
	r->octree_bytes = gw_gpu_read_account(scene->gpu).bytes;
}

bool gw_scene_needs_regions(const gw_bake_options *o)
{
	return o->voxels || o->method == GW_METHOD_CONES;
}

float gw_scene_leaf_spacing(const gw_scene *scene)
{
	const gw_bake_options *o = &scene->options;
	return gw_octree_leaf_spacing(o->leaf_spacing, scene->surfels.count, gw_scene_needs_regions(o));
}

gw_status gw_scene_build_octree(gw_scene *scene, gw_error *error)
{
	const gw_bake_options *o = &scene->options;
	const gw_octree_task task = { .surfels = &scene->surfels,
								  .depth = o->depth,
								  .leaf_spacing = o->leaf_spacing,
								  .regions = gw_scene_needs_regions(o),
								  .still = scene->still };
	GW_TRY(scene->keeps
			   ? gw_octree_build_kept(scene->gpu, &task, &scene->kept_octree, &scene->octree, error)
			   : gw_octree_build_task(scene->gpu, &task, &scene->octree, error));
	/* Octrees that keep what they can are all of one shape, but for large discs. */
	double seconds[GW_PASS_COUNT];
	memcpy(seconds, gw_passes_seconds(&scene->passes), sizeof seconds);
	if (scene->passes.gpu != NULL && !gw_octree_passes_fit(&scene->passes, &scene->octree))
		gw_passes_destroy(&scene->passes);
	if (scene->passes.gpu == NULL)
		gw_octree_passes(&scene->passes, scene->gpu, &scene->octree);
	memcpy(scene->passes.device_seconds, seconds, sizeof seconds);
	scene->passes.threads = o->threads;
	gw_scene_report_octree(scene);
	/* Light does without what leaves are as voxels. */
	if (!o->voxels)
		gw_buffer_destroy(scene->gpu, &scene->octree.leaf_geometry);
	if (o->method == GW_METHOD_CONES)
		gw_report_count(
			scene->report, "cones_pass", scene->octree.tree_discs,
			"point{|s} sparser than cones can see: light leaks between them; use rays, or a "
			"larger leaf spacing or less depth");
	return GW_OK;
}

gw_status gw_scene_do_without_octree(gw_scene *scene, gw_error *error)
{
	const gw_bake_options *o = &scene->options;
	const gw_octree_task task = { .surfels = &scene->surfels,
								  .depth = o->depth,
								  .leaf_spacing = o->leaf_spacing };
	GW_TRY(gw_octree_without_tree(scene->gpu, &task, &scene->octree, error));
	gw_octree_passes(&scene->passes, scene->gpu, &scene->octree);
	scene->passes.threads = o->threads;
	gw_scene_report_octree(scene);
	return GW_OK;
}

/* What emitters brought is not so any more. */
void gw_scene_forget_further(gw_scene *scene)
{
	gw_records_destroy(scene->gpu, &scene->further);
	gw_ray_gather_destroy(scene->gpu, &scene->further_rays);
}

void gw_scene_forget_samples(gw_scene *scene)
{
	gw_buffer_destroy(scene->gpu, &scene->sampled);
	gw_buffer_destroy(scene->gpu, &scene->sampled_moment);
	gw_check_point_hits_forget_emitted(&scene->check_points);
	gw_scene_forget_further(scene);
}

void gw_scene_forget_light(gw_scene *scene)
{
	gw_scene_forget_samples(scene);
	gw_check_point_hits_clear(&scene->check_points);
	gw_portals_destroy(scene->gpu, &scene->portals);
	gw_buffer_destroy(scene->gpu, &scene->rays.through);
}

static void drop_region_records(gw_region_needs *region)
{
	free(region->facet_spacing);
	free(region->lit);
	region->facet_spacing = NULL;
	region->lit = NULL;
}

static void clear_region(gw_region_needs *region)
{
	drop_region_records(region);
	free(region->asked);
	free(region->point);
	*region = (gw_region_needs){ 0 };
}

static void clear_density(gw_record_density *density)
{
	free(density->facet_spacing);
	free(density->surfel_spacing);
	free(density->facet_closer);
	free(density->surfel_closer);
	*density = (gw_record_density){ 0 };
}

void gw_scene_drop_records(gw_scene *scene)
{
	drop_region_records(&scene->region);
	gw_cone_gather_destroy(scene->gpu, &scene->cones);
	gw_volume_rows_destroy(scene->gpu, &scene->volume_rows);
	gw_propagation_destroy(scene->gpu, &scene->propagation);
	gw_radiance_volume_destroy(scene->gpu, &scene->volume);
	gw_micro_buffers_destroy(scene->gpu, &scene->buffers);
	gw_ray_gather_destroy(scene->gpu, &scene->rays);
	gw_portals_destroy(scene->gpu, &scene->portals);
	gw_records_destroy(scene->gpu, &scene->records);
	gw_scene_forget_further(scene);
	gw_read_back_clear(&scene->read_back);
	gw_buffer_destroy(scene->gpu, &scene->sampled);
	gw_buffer_destroy(scene->gpu, &scene->sampled_moment);
	gw_check_point_hits_clear(&scene->check_points);
	clear_density(&scene->density);
}

void gw_scene_drop_traced(gw_scene *scene)
{
	gw_check_tree_clear(&scene->check_tree);
	gw_cone_gather_destroy(scene->gpu, &scene->cones);
	gw_micro_buffers_destroy(scene->gpu, &scene->buffers);
	gw_ray_gather_destroy(scene->gpu, &scene->rays);
	gw_records_destroy(scene->gpu, &scene->records);
}

void gw_scene_drop_octree(gw_scene *scene)
{
	gw_scene_drop_records(scene);
	gw_placed_probes_clear(&scene->probes);
	gw_probe_maps_clear(&scene->maps);
	if (scene->passes.gpu)
		gw_passes_destroy(&scene->passes);
	scene->passes = (gw_passes){ 0 };
	gw_octree_destroy(scene->gpu, &scene->octree);
}

void gw_scene_close(gw_scene *scene)
{
	clear_region(&scene->region);
	gw_check_tree_clear(&scene->check_tree);
	gw_surfels_clear(&scene->surfels);
	gw_scanned_space_clear(&scene->space);
	if (scene->gpu == NULL)
		return;
	gw_scene_drop_octree(scene);
	gw_octree_kept_destroy(scene->gpu, &scene->kept_octree);
	if (scene->lent)
		*scene->lent = scene->gpu;
	else
		gw_gpu_destroy(&scene->gpu);
	scene->gpu = NULL;
}
