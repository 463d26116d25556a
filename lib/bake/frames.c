/*
 * frames.c - gw_frames: many frames of a scene in which points or lamps move; see glowworm.h.
 *
 * What stands still is prepared once: its surfels, the sorted fragments of its octree, and what the
 * records on it see while nothing else is there. A frame merges the movers' fragments in, traces
 * only rays that pass where the movers are, and is lit. Frames thus depend on what stands still and
 * on themselves, not on the frames before, but for the light with which bounces begin.
 */
#include "glowworm_host.h"
#include "light/direct_light.h"
#include "base/memory.h"
#include "bake/frames.h"
#include "bake/record_fields.h"
#include "bake/report.h"
#include "bake/result.h"
#include "bake/volume_light.h"
#include "bake/record_steps.h"
#include "bake/options_check.h"
#include "bake/lighting_steps.h"
#include "bake/lighting_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Leaf cells beyond its discs within which a mover may change leaves. */
#define CHANGED_MARGIN 1.5f

/* Of a frame, so that stages do not run into the next: the least that lies between two of them. */
#define STAGE_SHARE 0.02

static gw_status stage(gw_frames *f, const char *name, double done, gw_error *error)
{
	gw_report_stage(f->scene.report, f->scene.gpu, name);
	return gw_scene_begin(&f->scene, name, done, STAGE_SHARE, error);
}

/* -------------------------------------------------------------------------- what frames share */

static gw_status make_surfels(gw_frames *f, gw_error *error)
{
	double start = gw_seconds();
	const gw_surfels_options options =
		gw_scene_surfels_options(&f->scene, f->first_lights, f->first_light_count);
	gw_status status = stage(f, "surfels", 0.05, error);
	if (status == GW_OK)
		status = gw_surfel_parts_make(f->points, f->motion, &options, &f->parts, &f->scene.surfels,
									  error);
	f->scene.surfels.emission_alone = gw_scene_emission_is_alone(&f->scene);
	/* As wide as of all surfels, for octrees of those that stay as well. */
	f->scene.options.leaf_spacing = gw_scene_leaf_spacing(&f->scene);
	f->made = status == GW_OK;
	f->shared_seconds += gw_seconds() - start;
	return status;
}

static gw_status find_gaps(gw_frames *f, gw_error *error)
{
	double start = gw_seconds();
	gw_status status = stage(f, "gaps", 0.08, error);
	if (status == GW_OK)
		status = gw_scene_find_space(&f->scene, f->points, error);
	f->looked = status == GW_OK;
	f->shared_seconds += gw_seconds() - start;
	return status;
}

static bool shares(const gw_frames *f)
{
	return !f->how.rebuild && !f->alone && f->motion->mover_count > 0 && f->parts.still > 0;
}

static bool needs_places(const gw_frames *f)
{
	return f->light.plan.records || f->scene.options.volume ||
		   gw_options_record_fields(&f->scene.options);
}

void gw_frames_drop_geometry(gw_frames *f)
{
	gw_lighting_clear(&f->light);
	gw_scene_drop_records(&f->scene);
	gw_probe_maps_clear(&f->scene.maps);
	gw_octree_destroy(f->scene.gpu, &f->scene.octree);
	f->built = f->placed = false;
}

/* The octree of what stands still, for its fragments and for what its records see. */
static gw_status prepare_still(gw_frames *f, gw_error *error)
{
	gw_scene *s = &f->scene;
	size_t all = s->surfels.count;
	double start = gw_seconds();
	gw_status status = stage(f, "still part", 0.1, error);
	s->surfels.count = s->still = f->parts.still;
	s->keeps = true;
	if (status == GW_OK)
		status = gw_scene_build_octree(s, error);
	if (status == GW_OK && needs_places(f))
		status = gw_scene_keep_hits(s, &f->hits, error);
	s->surfels.count = all;
	gw_frames_drop_geometry(f);
	f->prepared = status == GW_OK;
	f->shared_seconds += gw_seconds() - start;
	return status;
}

/* ------------------------------------------------------------------------------------ a frame */

/* Where the surfels first .. last - 1 may have changed leaves. */
static gw_changed_box box_of(const gw_scene *s, size_t first, size_t last)
{
	gw_changed_box box = { { INFINITY, INFINITY, INFINITY, 0 },
						   { -INFINITY, -INFINITY, -INFINITY, 0 } };
	float radius = 0.0f, leaf = s->octree.leaf_size;
	for (size_t i = first; i < last; i++) {
		radius = fmaxf(radius, s->surfels.radius[i]);
		for (size_t k = 0; k < 3; k++) {
			float g = (s->surfels.position[3 * i + k] - s->octree.cube_minimum[k]) / leaf;
			box.low[k] = fminf(box.low[k], g);
			box.high[k] = fmaxf(box.high[k], g);
		}
	}
	for (size_t k = 0; k < 3; k++) {
		box.low[k] -= radius / leaf + CHANGED_MARGIN;
		box.high[k] += radius / leaf + CHANGED_MARGIN;
	}
	return box;
}

/* One box a mover; the last one holds all that there are no boxes for. */
static void find_boxes(gw_frames *f)
{
	size_t base = f->parts.still, movers = f->motion->mover_count;
	size_t boxes = movers < GW_CHANGED_BOXES ? movers : GW_CHANGED_BOXES;
	for (size_t m = 0; m < boxes; m++) {
		size_t end = m + 1 < boxes ? base + f->parts.own[m].count : f->scene.surfels.count;
		f->box[m] = box_of(&f->scene, base, end);
		base = end;
	}
	f->scene.boxes = (gw_changed_boxes){ f->box, (uint32_t)boxes };
}

static bool same_place(const gw_frames *f, size_t frame)
{
	size_t n = 16 * f->motion->mover_count;
	return f->built &&
		   (n == 0 || memcmp(f->motion->matrix + n * f->built_frame, f->motion->matrix + n * frame,
							 n * sizeof *f->motion->matrix) == 0);
}

static gw_status build(gw_frames *f, size_t frame, gw_error *error)
{
	bool tree = f->light.plan.octree;
	if (same_place(f, frame) && (f->tree || !tree)) {
		gw_scene_report_octree(&f->scene);
		return GW_OK;
	}
	gw_frames_drop_geometry(f);
	f->built = false;
	gw_surfel_parts_move(&f->parts, f->motion, frame, &f->scene.surfels);
	gw_check_tree_clear(&f->scene.check_tree);
	if (tree && shares(f) && !f->prepared)
		GW_TRY(prepare_still(f, error));
	GW_TRY(stage(f, "octree", 0.2, error));
	GW_TRY(tree ? gw_scene_build_octree(&f->scene, error)
				: gw_scene_do_without_octree(&f->scene, error));
	f->built = true;
	f->tree = tree;
	f->built_frame = frame;
	return GW_OK;
}

static gw_status place_records(gw_frames *f, gw_error *error)
{
	gw_status status = stage(f, "records", 0.4, error);
	if (status != GW_OK || f->placed)
		return status;
	f->scene.kept = f->hits.record_count > 0 ? &f->hits : NULL;
	if (f->scene.kept)
		find_boxes(f);
	status = gw_scene_place_records(&f->scene, error);
	f->placed = status == GW_OK;
	return status;
}

static gw_status gather(gw_frames *f, gw_error *error)
{
	GW_TRY(stage(f, "first gather", 0.6, error));
	GW_TRY(gw_lighting_gather_first(&f->light, error));
	GW_TRY(stage(f, "bounces", 0.7, error));
	f->light.carried = f->how.independent || f->how.rebuild ? NULL : f->carried;
	GW_TRY(gw_lighting_bounce(&f->light, error));
	GW_TRY(stage(f, "read back", 0.9, error));
	GW_TRY(gw_lighting_read_back(&f->light, error));
	if (f->scene.options.estimate_points == 0)
		return GW_OK;
	GW_TRY(stage(f, "estimate", 0.92, error));
	GW_TRY(gw_lighting_estimate(&f->light, error));
	f->scene.options.estimate_points = 0;
	return GW_OK;
}

/* The light goes over to the next frame. */
static void carry(gw_frames *f)
{
	free(f->carried);
	f->carried = f->light.surfel_indirect;
	f->light.surfel_indirect = NULL;
}

/* What is asked for besides the light. */
static gw_status collect(gw_frames *f, gw_bake_result *result, gw_error *error)
{
	const gw_bake_options *o = &f->scene.options;
	if (gw_options_record_fields(o))
		GW_TRY(gw_record_fields_collect(&f->light, result, error));
	if (o->volume)
		GW_TRY(gw_volume_light_collect(&f->light, result, error));
	if (o->voxels)
		GW_TRY(gw_result_collect_voxels(&f->light, result, error));
	GW_TRY(stage(f, "points", 0.95, error));
	GW_TRY(gw_result_collect(&f->light, result, error));
	carry(f);
	f->light.carried = NULL;
	if (o->lamps)
		GW_TRY(gw_result_collect_lamps(&f->light, result, error));
	return GW_OK;
}

gw_status gw_frames_light(gw_frames *f, size_t frame, gw_error *error)
{
	GW_TRY(stage(f, "device", 0.0, error));
	if (!f->scene.gpu)
		GW_TRY(gw_scene_open_device(&f->scene, error));
	if (!f->made)
		GW_TRY(make_surfels(f, error));
	gw_report_surfels(f->scene.report, &f->scene.surfels, f->points);
	gw_scene_report_space(&f->scene);
	gw_lighting_plan(&f->light);
	if (f->light.plan.gaps && !f->looked)
		GW_TRY(find_gaps(f, error));
	GW_TRY(build(f, frame, error));
	GW_TRY(stage(f, "direct light", 0.35, error));
	return gw_lighting_direct(&f->light, error);
}

gw_status gw_frames_solve(gw_frames *f, size_t frame, gw_bake_result *result, gw_error *error)
{
	GW_TRY(gw_frames_light(f, frame, error));
	if (needs_places(f))
		GW_TRY(place_records(f, error));
	if (f->light.plan.records)
		GW_TRY(gather(f, error));
	return collect(f, result, error);
}

void gw_frames_forget(gw_frames *f)
{
	if (f->scene.gpu) {
		gw_frames_drop_geometry(f);
		gw_kept_hits_destroy(f->scene.gpu, &f->hits);
	}
	gw_scene_close(&f->scene);
	gw_surfel_parts_clear(&f->parts);
	free(f->carried);
	f->carried = NULL;
	f->made = f->prepared = f->looked = false;
}

/* A frame, by lights in the units of the frames, into a result in metres. */
static gw_status bake_in_units(gw_frames *f, size_t frame, gw_bake_result *result, gw_error *error)
{
	f->scene.report = &result->report;
	gw_status status = gw_frames_solve(f, frame, result, error);
	gw_report_stage(&result->report, f->scene.gpu, NULL);
	gw_report_device(&result->report, f->scene.gpu);
	if (status == GW_OK)
		status = gw_scene_check_validation(&f->scene, error);
	f->scene.report = NULL;
	return status == GW_OK ? gw_scaled_scene_undo(&f->units, result, error) : status;
}

gw_status gw_frames_bake(gw_frames *f, size_t frame, const gw_light *lights, size_t light_count,
						 gw_bake_result **result, gw_error *error)
{
	*result = NULL;
	if (frame >= f->motion->frame_count)
		return gw_fail(error, GW_ERROR_USAGE, "there is no frame %zu; the last one is %zu", frame,
					   f->motion->frame_count - 1);
	gw_light *own;
	GW_TRY(gw_lights_check(lights, light_count, error));
	GW_TRY(gw_scaled_lights(&f->units, lights, light_count, &own, error));
	gw_bake_result *r = gw_allocate_zeros(1, sizeof *r);
	if (!r) {
		free(own);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a result");
	}
	if (f->how.rebuild)
		gw_frames_forget(f);
	f->light.lights = own;
	f->light.light_count = light_count;
	gw_status status = bake_in_units(f, frame, r, error);
	f->light.lights = NULL;
	f->light.light_count = 0;
	free(own);
	if (status == GW_OK)
		*result = r;
	else
		gw_bake_result_destroy(&r);
	return status;
}

/* The furthest that a matrix shifts anything, metres. */
static double reach_of(const gw_motion *motion)
{
	double reach = 0.0;
	for (size_t i = 0; i < motion->mover_count * motion->frame_count; i++)
		for (size_t row = 0; row < 3; row++)
			reach = fmax(reach, fabs(motion->matrix[16 * i + 4 * row + 3]));
	return reach;
}

/* Takes the scene over, in units that suit it. */
static gw_status take_scene(gw_frames *f, const gw_moving_scene *scene,
							const gw_bake_options *options, gw_error *error)
{
	const gw_motion *motion = scene->motion;
	size_t matrices = motion->mover_count * motion->frame_count;
	const gw_bake_options effective = gw_options_effective(options);
	GW_TRY(gw_scaled_scene_make(&scene->scene, &effective, reach_of(motion), &f->units, error));
	f->scene.options = f->units.options;
	f->points = f->units.scene.points;
	f->first_lights = f->units.scene.lights;
	f->first_light_count = f->units.scene.light_count;
	f->motion = motion;
	if (f->units.length == 0 || matrices == 0)
		return GW_OK;
	f->matrix = gw_allocate_array(16 * matrices, sizeof *f->matrix);
	if (!f->matrix)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a motion of %zu frames",
					   motion->frame_count);
	memcpy(f->matrix, motion->matrix, 16 * matrices * sizeof *f->matrix);
	for (size_t i = 0; i < matrices; i++)
		for (size_t row = 0; row < 3; row++)
			f->matrix[16 * i + 4 * row + 3] =
				ldexp(f->matrix[16 * i + 4 * row + 3], f->units.length);
	f->own_motion = *motion;
	f->own_motion.matrix = f->matrix;
	f->motion = &f->own_motion;
	return GW_OK;
}

gw_status gw_frames_open(const gw_moving_scene *scene, const gw_bake_options *options,
						 const gw_frames_options *how, const gw_bake_callbacks *callbacks,
						 gw_frames **frames, gw_error *error)
{
	const gw_points *points = scene->scene.points;
	const gw_motion *motion = scene->motion;
	*frames = NULL;
	GW_TRY(gw_options_check(options, &scene->scene, error));
	if (gw_options_refine(options))
		return gw_fail(error, GW_ERROR_USAGE,
					   "frames are all baked with the same settings; they cannot be refined until "
					   "an error or a time is reached");
	if (options->transport)
		return gw_fail(error, GW_ERROR_USAGE,
					   "frames in which something moves cannot begin with a transport nor make "
					   "one; leave it out");
	if (options->surface_points > 0)
		return gw_fail(
			error, GW_ERROR_USAGE,
			"the surface of frames is made of all points; leave their number out, or bake "
			"each as a scene of its own");
	if (options->region)
		return gw_fail(error, GW_ERROR_USAGE,
					   "frames are of the whole scene; bake each as a scene of its own to light a "
					   "region of it");
	GW_TRY(gw_motion_check(points, motion, error));
	gw_frames *f = gw_allocate_zeros(1, sizeof *f);
	if (f)
		f->box = gw_allocate_zeros(GW_CHANGED_BOXES, sizeof *f->box);
	if (!f || !f->box) {
		free(f);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for frames");
	}
	f->how = *how;
	if (callbacks)
		f->scene.callbacks = *callbacks;
	f->light = (gw_lighting){ .scene = &f->scene };
	gw_status status = take_scene(f, scene, options, error);
	if (status == GW_OK)
		*frames = f;
	else
		gw_frames_close(&f);
	return status;
}

double gw_frames_shared_seconds(const gw_frames *frames)
{
	return frames->shared_seconds;
}

void gw_frames_close(gw_frames **frames)
{
	gw_frames *f = *frames;
	if (f == NULL)
		return;
	gw_frames_forget(f);
	gw_scaled_scene_clear(&f->units);
	free(f->matrix);
	free(f->box);
	free(f);
	*frames = NULL;
}
