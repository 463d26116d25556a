/*
 * scene.c - see scene.h.
 */
#include "bake/scene.h"
#include "bake/probes.h"
#include "bake/region.h"

#include "light/direct_light.h"
#include "glowworm_host.h"
#include "base/memory.h"
#include "base/nth_element.h"
#include "octree/compartments.h"
#include "bake/report.h"
#include "cloud/strays.h"
#include "cloud/frame.h"
#include "surfels/surface_holes.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rays a record that only look for the nearest surface, when cones gather. */
#define NEAREST_RAYS 16u

/* Seconds between two questions whether to stop. */
#define ASKED_EVERY 0.1

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

bool gw_options_few_records(const gw_bake_options *o)
{
	bool known = o->estimate_points > 0 || !(o->gathered_error > 0.0f);
	return o->method == GW_METHOD_RAYS && o->record_spacing > 0.0f && !o->region && !o->transport &&
		   known;
}

static bool forbids(const gw_bake_options *o, gw_effect_kind effect)
{
	return o->effects_forbidden & 1u << effect;
}

static bool forces(const gw_bake_options *o, gw_effect_kind effect)
{
	return o->effects_forced & 1u << effect;
}

gw_bake_options gw_options_effective(const gw_bake_options *options)
{
	gw_bake_options o = *options;
	if (forbids(&o, GW_EFFECT_SHADOWS))
		o.shadows = GW_SHADOWS_NONE;
	if (forbids(&o, GW_EFFECT_BOUNCES) && o.bounces > 1)
		o.bounces = 1;
	if (forbids(&o, GW_EFFECT_ERROR))
		o.estimate_points = 0;
	if (forces(&o, GW_EFFECT_NORMALS))
		o.normals = GW_NORMALS_ESTIMATE;
	if (forbids(&o, GW_EFFECT_NORMALS))
		o.normals = GW_NORMALS_GIVEN;
	if (forces(&o, GW_EFFECT_COLUMNS))
		o.lamps = true;
	return o;
}

/* Effects that are forced or forbidden against what other options say. */
static gw_status check_effects(const gw_bake_options *o, gw_error *error)
{
	const uint32_t known = (1u << GW_EFFECT_KIND_COUNT) - 1;
	const struct {
		uint32_t effects;
		gw_effect_kind effect;
		bool contradicted;
		const char *what;
	} rows[] = {
		{ o->effects_forced, GW_EFFECT_SHADOWS, o->shadows == GW_SHADOWS_NONE,
		  "is forced, but no kind of shadows is chosen" },
		{ o->effects_forced, GW_EFFECT_BOUNCES, o->bounces < 2,
		  "is forced, but the number of bounces leaves no second reflection" },
		{ o->effects_forced, GW_EFFECT_ERROR, o->estimate_points == 0,
		  "is forced, but no points are to be solved again for it" },
		{ o->effects_forbidden, GW_EFFECT_ERROR, gw_options_refine(o),
		  "is forbidden, but the bake is to go on until an error or a time is reached" },
		{ o->effects_forbidden, GW_EFFECT_GAPS, o->gaps != GW_GAPS_OPEN || o->unknown,
		  "is forbidden, but gaps are to be closed or written" },
		{ o->effects_forbidden, GW_EFFECT_NORMALS, o->normals == GW_NORMALS_ESTIMATE,
		  "is forbidden, but all normals are to be estimated" },
		{ o->effects_forbidden, GW_EFFECT_COLUMNS, o->lamps,
		  "is forbidden, but the light of each lamp is asked for" },
		{ o->effects_forbidden, GW_EFFECT_OCTREE, true,
		  "is forbidden; there is none where shadows, emitters, sky and bounces are" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (rows[i].contradicted && rows[i].effects & 1u << rows[i].effect)
			return gw_fail(error, GW_ERROR_USAGE, "the effect '%s' %s",
						   gw_effect_name(rows[i].effect), rows[i].what);
	if (o->effects_forced & o->effects_forbidden)
		return gw_fail(error, GW_ERROR_USAGE, "an effect is both forced and forbidden");
	if ((o->effects_forced | o->effects_forbidden) & ~known)
		return gw_fail(error, GW_ERROR_USAGE, "an effect to be forced or forbidden is not known");
	return GW_OK;
}

bool gw_options_openness(const gw_bake_options *o)
{
	return o->ambient_occlusion || o->bent_normals;
}

bool gw_options_record_fields(const gw_bake_options *o)
{
	return gw_options_openness(o) || o->errors || o->unknown;
}

/* Cells along the longest side where their number is left to the method. Light that goes from cell
 * to cell spreads more, and takes longer, the more there are. */
#define VOLUME_CELLS 64u
#define LPV_CELLS 16u

static gw_status check_volume(const gw_bake_options *o, gw_error *error)
{
	if (o->volume_harmonics != 4 && o->volume_harmonics != 9)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a cell of a volume can have 4 or 9 spherical harmonics, not %u",
					   o->volume_harmonics);
	if (o->method == GW_METHOD_LPV && o->volume_harmonics != 4 && !o->volume)
		return gw_fail(error, GW_ERROR_USAGE,
					   "light that goes from cell to cell has 4 spherical harmonics, not %u; leave "
					   "their number out, or gather it by a volume",
					   o->volume_harmonics);
	if (gw_method_has_cells(o->method) && gw_options_refine(o))
		return gw_fail(error, GW_ERROR_USAGE,
					   "a volume is not refined until an error or a time is reached; ask for more "
					   "cells, or gather by rays");
	if (o->method == GW_METHOD_BUFFERS && gw_options_refine(o))
		return gw_fail(error, GW_ERROR_USAGE,
					   "buffers are not refined until an error or a time is reached; ask for a "
					   "higher quality, or gather by rays");
	if (gw_method_has_cells(o->method) && o->lamps)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the light of single lamps does not add up where a volume gathers, which "
					   "holds each above 0; gather by rays for it");
	return GW_OK;
}

static gw_status check_probes(const gw_bake_options *o, gw_error *error)
{
	gw_probes_options probes = gw_probes_options_default();
	probes.size = o->probe_size;
	if (gw_options_refine(o))
		return gw_fail(error, GW_ERROR_USAGE,
					   "what probes see is not refined until an error or a time is reached; ask "
					   "for larger maps, or gather by rays");
	return gw_probes_options_check(&probes, error);
}

static gw_status check_region(const gw_bake_options *o, gw_error *error)
{
	const gw_region *r = o->region;
	if (!r)
		return GW_OK;
	if (o->method != GW_METHOD_RAYS)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the light of a region is gathered by rays; leave out the method '%s'",
					   gw_method_name(o->method));
	if (o->transport || o->voxels || o->volume)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a region is lit alone, and %s of the whole scene; bake the whole for it",
					   o->transport ? "a transport is" : "grids are");
	if (r->camera && !(r->aspect >= 1.0 / 64.0 && r->aspect <= 64.0))
		return gw_fail(error, GW_ERROR_USAGE,
					   "the picture of a region's camera has a width of %g by its height; give "
					   "1/64 to 64",
					   r->aspect);
	return GW_OK;
}

gw_status gw_options_check(const gw_bake_options *o, const gw_scene_description *scene,
						   gw_error *error)
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
		{ "number of cells of a volume", o->volume_cells > 0 ? o->volume_cells : VOLUME_CELLS,
		  GW_VOLUME_CELLS_LEAST, GW_VOLUME_CELLS_MOST },
		{ "record spacing", (double)o->record_spacing, 0, 64 },
		{ "shadow map size", o->shadow_map_size, 16, 8192 },
		{ "largest error", (double)o->max_error, 0, 1 },
		{ "largest error of gathered light", (double)o->gathered_error, 0, 1 },
		{ "occlusion distance", (double)o->ambient_occlusion_distance, 0, 1e9 },
		{ "time limit", (double)o->time_limit, 0, 1e9 },
		{ "method", (double)o->method, 0, GW_METHOD_COUNT - 1 },
		{ "basis", (double)o->basis, 0, GW_BASIS_COUNT - 1 },
		{ "shadows", (double)o->shadows, 0, GW_SHADOWS_COUNT - 1 },
		{ "gaps", (double)o->gaps, 0, GW_GAPS_COUNT - 1 },
		{ "radiance of gaps", (double)o->gap_radiance, 0, 1e30 },
		{ "passes", (double)o->passes, 0, GW_PASSES_COUNT - 1 },
		{ "normals", (double)o->normals, 0, GW_NORMALS_COUNT - 1 },
		{ "validation", (double)o->validate, 0, GW_VALIDATION_COUNT - 1 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		GW_TRY(check_number(rows[i].name, rows[i].value, rows[i].low, rows[i].high, error));
	GW_TRY(check_effects(o, error));
	if (scene->points->count == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "the cloud holds no points, so there is nothing to light");
	if (gw_options_refine(o) && o->estimate_points == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "an error or a time to aim at needs an estimate of the error; let it have "
					   "at least one point");
	if (gw_options_refine(o) && o->transport)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a bake that refines its settings cannot begin with a transport nor make "
					   "one; leave out the error or time to aim at");
	if (o->basis == GW_BASIS_DIRECTIONAL &&
		(!gw_method_keeps_hits(o->method) || o->gaps != GW_GAPS_OPEN))
		return gw_fail(error, GW_ERROR_USAGE,
					   "records know from where their light comes only if they gather by rays and "
					   "gaps are open; leave the basis to the bake");
	if (o->gaps != GW_GAPS_OPEN && o->method != GW_METHOD_RAYS)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s not know gaps; leave these open, or gather by rays",
					   o->method == GW_METHOD_CONES     ? "cones do"
					   : o->method == GW_METHOD_PROBES  ? "probes do"
					   : o->method == GW_METHOD_BUFFERS ? "buffers do"
														: "a volume does");
	GW_TRY(check_volume(o, error));
	if (o->method == GW_METHOD_PROBES)
		GW_TRY(check_probes(o, error));
	GW_TRY(check_region(o, error));
	if (o->gap_radiance > 0.0f && (o->lamps || o->gaps != GW_GAPS_BLACK))
		return gw_fail(error, GW_ERROR_USAGE,
					   "a radiance of gaps takes gaps that are black without it, and is no lamp's: "
					   "leave out the light of single lamps, or say black for gaps");
	return gw_lights_check(scene->lights, scene->light_count, error);
}

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
			length += snprintf(meaning + length, sizeof meaning - (size_t)length,
							   "%s %" PRIu64 " %s (%.6g, %.6g, %.6g)",
							   meaning[length - 1] == ':' ? "" : ",", count->points,
							   gw_stray_kind_name((gw_stray_kind)kind), count->position[0],
							   count->position[1], count->position[2]);
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
	r->spacing_ratio = 1.0;
	if (s->count == 0 || !s->radius || !s->clip) /* of stored transport */
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
	if (forbids(o, GW_EFFECT_GAPS))
		return GW_OK;
	GW_TRY(gw_scanned_space_make(points, &scene->surfels, o->threads, &scene->space, error));
	if (scene->space.scanners == 0)
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
	return forbids(&scene->options, GW_EFFECT_EMITTERS) && !scene->options.voxels;
}

gw_status gw_scene_make_surfels(gw_scene *scene, const gw_scene_description *from, gw_error *error)
{
	const gw_surfels_options options =
		gw_scene_surfels_options(scene, from->lights, from->light_count);
	GW_TRY(gw_surfels_make(from->points, &options, &scene->surfels, error));
	scene->surfels.emission_alone = gw_scene_emission_is_alone(scene);
	gw_report_surfels(scene->report, &scene->surfels, from->points);
	return gw_region_ask(scene, error);
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

static uint32_t ray_count(const gw_bake_options *o)
{
	return gw_method_keeps_hits(o->method) ? o->rays : NEAREST_RAYS;
}

gw_status gw_scene_build_octree(gw_scene *scene, gw_error *error)
{
	const gw_bake_options *o = &scene->options;
	const gw_octree_task task = { &scene->surfels, scene->still, o->depth, o->leaf_spacing };
	GW_TRY(scene->keeps
			   ? gw_octree_build_kept(scene->gpu, &task, &scene->kept_octree, &scene->octree, error)
		   : o->depth == GW_DEPTH_AUTO
			   ? gw_octree_build_spaced(scene->gpu, &scene->surfels, o->leaf_spacing,
										&scene->octree, error)
			   : gw_octree_build(scene->gpu, &scene->surfels, o->depth, &scene->octree, error));
	/* Octrees that keep what they can are all of one shape, but for large discs. */
	double seconds[GW_PASS_COUNT];
	memcpy(seconds, scene->passes.device_seconds, sizeof seconds);
	if (scene->passes.gpu != NULL && !gw_octree_passes_fit(&scene->passes, &scene->octree))
		gw_passes_destroy(&scene->passes);
	if (scene->passes.gpu == NULL)
		gw_octree_passes(&scene->passes, scene->gpu, &scene->octree);
	memcpy(scene->passes.device_seconds, seconds, sizeof seconds);
	scene->passes.threads = o->threads;
	gw_scene_report_octree(scene);
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
	const gw_octree_task task = { &scene->surfels, scene->still, o->depth, o->leaf_spacing };
	GW_TRY(gw_octree_without_tree(scene->gpu, &task, &scene->octree, error));
	gw_octree_passes(&scene->passes, scene->gpu, &scene->octree);
	scene->passes.threads = o->threads;
	gw_scene_report_octree(scene);
	return GW_OK;
}

static void report_rays(gw_scene *scene)
{
	gw_report *r = scene->report;
	r->rays = (uint64_t)scene->rays.rays * scene->records.count;
	r->rays_traced = scene->kept ? scene->traced : r->rays;
}

/* What the records see by the maps of probes. */
static gw_status follow_maps(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	gw_probe_maps maps;
	GW_TRY(gw_scene_probe_maps(scene, &maps, error));
	gw_status status = gw_probe_gather_trace(&on, &maps, scene->options.rays,
											 (uint32_t)scene->options.seed, &scene->rays, error);
	scene->traced = (uint64_t)scene->options.rays * scene->records.count;
	gw_probe_maps_clear(&maps);
	return status;
}

/* What the records see; for cones, how near their surroundings are. */
static gw_status trace_records(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_bake_options *o = &scene->options;
	if (o->method == GW_METHOD_PROBES)
		GW_TRY(follow_maps(scene, error));
	else if (scene->kept)
		GW_TRY(gw_kept_hits_trace(&on, scene->kept, scene->boxes, &scene->rays, &scene->traced,
								  error));
	else
		GW_TRY(gw_ray_gather_trace(&on, ray_count(o), (uint32_t)o->seed, &scene->rays, error));
	report_rays(scene);
	return gw_ray_gather_look(&on, &scene->rays, error);
}

static void report_records(gw_scene *scene)
{
	scene->report->records = scene->records.count;
	scene->report->record_spacing =
		scene->region.asked ? scene->region.spacing : scene->records.spacing;
}

gw_volume_wish gw_scene_wish_volume(const gw_scene *scene)
{
	const gw_bake_options *o = &scene->options;
	return (gw_volume_wish){ .surfels = &scene->surfels,
							 .cells = o->volume_cells > 0 ? o->volume_cells : VOLUME_CELLS,
							 .order = o->volume_harmonics == 9 ? 3 : 2,
							 .rays = o->rays,
							 .seed = (uint32_t)o->seed,
							 .whole = o->volume };
}

/* Light that goes from cell to cell needs them all, and no rays. */
static gw_status make_propagation(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	gw_volume_wish wish = gw_scene_wish_volume(scene);
	if (scene->options.volume_cells == 0)
		wish.cells = LPV_CELLS;
	wish.order = 2;
	wish.rays = 0;
	wish.whole = true;
	GW_TRY(gw_radiance_volume_make(&on, &wish, &scene->volume, error));
	return gw_propagation_make(&on, &scene->volume, &scene->propagation, error);
}

/* Cells of a volume, what they see, and which of them light each record. */
static gw_status make_volume(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_volume_wish wish = gw_scene_wish_volume(scene);
	GW_TRY(gw_compartments_find(scene->gpu, &scene->surfels, scene->options.threads, &scene->octree,
								error));
	GW_TRY(scene->options.method == GW_METHOD_LPV
			   ? make_propagation(scene, error)
			   : gw_radiance_volume_make(&on, &wish, &scene->volume, error));
	scene->report->volume_cells = scene->volume.count;
	return gw_volume_weigh_records(&on, &scene->volume, &scene->volume_rows, error);
}

/* Buffers of the records, and what these show. */
static gw_status draw_buffers(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_bake_options *o = &scene->options;
	GW_TRY(gw_micro_buffers_make(&on, o->rays, (uint32_t)o->seed, &scene->buffers, error));
	scene->report->buffer_pieces = scene->buffers.drawn;
	return GW_OK;
}

/* Work space of cones, a volume or buffers. */
static gw_status make_pools(gw_scene *scene, gw_error *error)
{
	const gw_bake_options *o = &scene->options;
	if (gw_method_has_cells(o->method))
		return make_volume(scene, error);
	if (o->method == GW_METHOD_BUFFERS)
		return draw_buffers(scene, error);
	if (o->method != GW_METHOD_CONES)
		return GW_OK;
	GW_TRY(gw_cone_gather_create(scene->gpu, &scene->octree, o->cones, (uint32_t)o->seed,
								 &scene->cones, error));
	scene->report->brick_bytes = scene->cones.leaf_pool.allocated + scene->cones.mip_pool.allocated;
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

gw_record_wish gw_scene_wish_records(const gw_scene *scene, const gw_bake_options *o)
{
	bool few = scene->adds_records && gw_options_few_records(o);
	return (gw_record_wish){ .spacing = o->record_spacing,
							 .least = gw_records_least(&scene->surfels, o->least_records),
							 .most = few ? o->most_records : 0,
							 .seed = o->seed };
}

/* Normals that are turned by less on the average, radians, read the same light. */
#define TURN_LEAST 0.02

/* Of normals that are off by this share of how far they are turned, what they read is noise. */
#define OFF_MOST 0.5

/* By how much normals are off: the root of the mean square, radians; of noisy points how far their
 * own normals are turned from the surface's counts as well. */
static double normals_off(const gw_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	const bool *asked = scene->region.asked;
	double sum = 0.0;
	for (size_t i = 0; i < s->count && s->shading_normal_off; i++)
		if (!asked || asked[i])
			sum += (double)s->shading_normal_off[i] * (double)s->shading_normal_off[i];
	for (size_t i = 0; i < s->count && s->shading_normal; i++) {
		const float *a = s->normal + 3 * i, *b = s->shading_normal + 3 * i;
		double cosine = (double)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
		if (!asked || asked[i])
			sum += fmax(0.0, 1.0 - cosine * cosine);
	}
	return sqrt(sum / (double)(asked ? scene->region.count : s->count));
}

/* By how far normals are turned from theirs, unless that is noise. */
gw_status gw_scene_measure_turn(gw_scene *scene, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	gw_view normal;
	scene->turn = 0.0;
	if (!gw_method_keeps_hits(scene->options.method) || scene->options.basis != GW_BASIS_AUTO)
		return GW_OK;
	GW_TRY(gw_view_open(scene->gpu, &scene->records.normal, 16 * (uint64_t)scene->records.count,
						&normal, error));
	scene->turn =
		gw_read_back_turn(&scene->read_back, normal.bytes, s->normal, scene->options.threads);
	gw_view_close(&normal);
	if (scene->region.asked) /* the rows of others are empty by then */
		scene->turn *= sqrt((double)s->count / (double)scene->region.count);
	if (normals_off(scene) > OFF_MOST * scene->turn)
		scene->turn = 0.0;
	return GW_OK;
}

gw_status gw_scene_place_records(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_record_wish wish = gw_scene_wish_records(scene, &scene->options);
	if (scene->region.asked) {
		GW_TRY(gw_region_place_records(scene, error));
		report_records(scene);
		report_rays(scene);
		return GW_OK;
	}
	GW_TRY(gw_records_place(&on, &wish, error));
	report_records(scene);
	GW_TRY(trace_records(scene, error));
	GW_TRY(make_pools(scene, error));
	GW_TRY(gw_records_weigh_facets(&on, NULL, error));
	GW_TRY(gw_read_back_make(&on, scene->surfels.count, &scene->read_back, error));
	return gw_scene_measure_turn(scene, error);
}

gw_status gw_scene_list_further(gw_scene *scene, uint32_t first, gw_error *error)
{
	gw_records *all = &scene->records;
	size_t count = all->count - first;
	float *rows = gw_allocate_array(count, 8 * sizeof *rows);
	if (!rows)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	gw_status status = gw_buffer_download(scene->gpu, &all->position, 16 * (uint64_t)first, rows,
										  16 * count, error);
	if (status == GW_OK)
		status = gw_buffer_download(scene->gpu, &all->normal, 16 * (uint64_t)first,
									rows + 4 * count, 16 * count, error);
	if (status == GW_OK)
		status = gw_records_put(scene->gpu, rows, rows + 4 * count, (uint32_t)count,
								&scene->further, error);
	free(rows);
	return status;
}

/* Which records light what, where they have come closer. */
static gw_status weigh_again(gw_scene *s, const gw_record_density *density, gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_own_spacings facet = { density->facet_spacing, density->facet_closer,
									2 * (size_t)s->octree.leaf_count };
	const gw_own_spacings surfel = { density->surfel_spacing, density->surfel_closer,
									 s->surfels.count };
	gw_buffer facets = { 0 }, surfels = { 0 };
	gw_status status =
		gw_records_reach(s->gpu, &s->records, GW_FACET_REACH, &facet, &facets, error);
	if (status == GW_OK)
		status = gw_records_reach(s->gpu, &s->records, GW_SURFEL_REACH, &surfel, &surfels, error);
	if (status == GW_OK)
		status = gw_records_weigh_facets(&on, &facets, error);
	if (status == GW_OK)
		status = gw_read_back_again(&on, &surfels, density->surfel_closer, &s->read_back, error);
	gw_buffer_destroy(s->gpu, &facets);
	gw_buffer_destroy(s->gpu, &surfels);
	return status;
}

gw_status gw_scene_add_records(gw_scene *scene, const gw_record_density *density, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_record_context further = gw_scene_context(scene, &scene->further);
	uint32_t before = scene->records.count;
	gw_scene_forget_further(scene);
	GW_TRY(gw_records_add(&on, scene->options.seed, density->facet_spacing, error));
	report_records(scene);
	if (scene->records.count > before)
		GW_TRY(gw_scene_list_further(scene, before, error));
	if (scene->further.count > 0)
		GW_TRY(gw_ray_gather_add(&further, &scene->rays, &scene->further_rays, error));
	report_rays(scene);
	GW_TRY(gw_ray_gather_look(&on, &scene->rays, error));
	GW_TRY(weigh_again(scene, density, error));
	return scene->region.asked ? GW_OK : gw_scene_measure_turn(scene, error);
}

bool gw_scene_keeps_moments(const gw_scene *scene)
{
	const gw_bake_options *o = &scene->options;
	bool closed = o->gaps != GW_GAPS_OPEN && gw_scanned_space_known(&scene->space);
	if (!gw_method_keeps_hits(o->method) || closed || o->basis == GW_BASIS_SCALAR)
		return false;
	return o->basis == GW_BASIS_DIRECTIONAL || scene->turn >= TURN_LEAST;
}

gw_status gw_scene_find_compartments(gw_scene *s, gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_record_context further = gw_scene_context(s, &s->further);
	GW_TRY(gw_compartments_find(s->gpu, &s->surfels, s->options.threads, &s->octree, error));
	if (s->buffers.hits.facet.handle != VK_NULL_HANDLE)
		return gw_micro_buffers_shut_out(&on, &s->buffers, error);
	if (!gw_method_keeps_hits(s->options.method) || s->rays.facet.handle == VK_NULL_HANDLE)
		return GW_OK;
	GW_TRY(gw_ray_gather_shut_out(&on, &s->rays, error));
	return s->further.count > 0 ? gw_ray_gather_shut_out(&further, &s->further_rays, error) : GW_OK;
}

gw_status gw_scene_open_to_sky(gw_scene *s, gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_record_context further = gw_scene_context(s, &s->further);
	if (!s->portals.looked && !forbids(&s->options, GW_EFFECT_PORTALS))
		GW_TRY(gw_portals_find(&s->passes, &s->octree, &s->records, &s->rays, &s->portals, error));
	if (s->further.count > 0)
		GW_TRY(
			gw_ray_gather_open_further(&further, &s->portals, &s->rays, &s->further_rays, error));
	return gw_ray_gather_open(&on, &s->portals, &s->rays, error);
}

gw_status gw_scene_complete(gw_scene *scene, const gw_points *points, gw_error *error)
{
	gw_report_surfels(scene->report, &scene->surfels, points);
	gw_scene_report_octree(scene);
	report_records(scene);
	GW_TRY(gw_scene_find_space(scene, points, error));
	GW_TRY(gw_records_make_room(scene->gpu, &scene->records, error));
	GW_TRY(gw_scene_measure_turn(scene, error));
	return make_pools(scene, error);
}

gw_status gw_scene_keep_hits(gw_scene *scene, gw_kept_hits *kept, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_bake_options *o = &scene->options;
	const gw_record_wish wish = gw_scene_wish_records(scene, o);
	gw_status status = gw_records_place(&on, &wish, error);
	if (status == GW_OK) { /* each frame gets what stands still got, so that its light keeps */
		scene->options.record_spacing = scene->records.spacing;
		scene->options.least_records = 0;
		status = gw_ray_gather_trace(&on, ray_count(o), (uint32_t)o->seed, &scene->rays, error);
	}
	if (status == GW_OK)
		status = gw_kept_hits_take(scene->gpu, &scene->octree, &scene->records, &scene->rays, kept,
								   error);
	gw_scene_drop_records(scene);
	return status;
}

void gw_scene_drop_records(gw_scene *scene)
{
	gw_region_drop_records(&scene->region);
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
}

void gw_scene_drop_octree(gw_scene *scene)
{
	gw_scene_drop_records(scene);
	if (scene->passes.gpu)
		gw_passes_destroy(&scene->passes);
	scene->passes = (gw_passes){ 0 };
	gw_octree_destroy(scene->gpu, &scene->octree);
}

void gw_scene_close(gw_scene *scene)
{
	gw_region_clear(&scene->region);
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
