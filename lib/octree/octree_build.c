/*
 * octree_build.c - builds the octree from surfels; the steps are in octree_steps.h.
 */
#include "octree/compartments.h"
#include "octree/octree_steps.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double extent_of(const gw_surfels *surfels)
{
	double extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)surfels->maximum[k] - (double)surfels->minimum[k]);
	return extent;
}

/* The least depth whose cube has that many cells a side and two free ones on each; NaN gives 1. */
static uint32_t depth_of(double cells)
{
	for (uint32_t depth = 1; depth < GW_DEPTH_MAX; depth++) {
		double side = (double)(1u << depth);
		if (!(cells > side - 2 * fmin(2, side / 4)))
			return depth;
	}
	return GW_DEPTH_MAX;
}

/* Points of the largest cloud whose leaves are as narrow as they may be. */
#define NARROW_POINTS 250000.0

float gw_octree_leaf_spacing(float asked, size_t surfels, bool regions)
{
	if (asked > 0.0f)
		return asked;
	double more = regions ? 1.0 : fmax((double)surfels / NARROW_POINTS, 1.0);
	return GW_LEAF_SPACING * (float)sqrt(sqrt(more));
}

/* Metres. */
static double leaf_size_of(const gw_octree_task *task)
{
	float spacing = gw_octree_leaf_spacing(task->leaf_spacing, task->surfels->count, task->regions);
	return (double)spacing * (double)task->surfels->spacing;
}

uint32_t gw_octree_auto_depth(const gw_surfels *surfels)
{
	const gw_octree_task task = { .surfels = surfels, .leaf_spacing = GW_LEAF_SPACING_AUTO };
	return depth_of(extent_of(surfels) / leaf_size_of(&task));
}

/* Passes of the octree write lists as texels; a shader that sorts binds them as storage, which some
 * devices have less room for. */
uint64_t gw_octree_most_fragments(gw_gpu *gpu)
{
	const VkPhysicalDeviceLimits *limits = gw_gpu_limits(gpu);
	const gw_passes passes = { .gpu = gpu };
	uint64_t most = limits->maxTexelBufferElements, bound = limits->maxStorageBufferRange / 4;
	if (gw_passes_way(&passes, GW_PASS_RADIX_SCATTER) == GW_WAY_DEVICE && bound < most)
		most = bound;
	return most < UINT32_MAX - 1 ? most : UINT32_MAX - 1;
}

static bool fragments_fit(const gw_octree_work *work, uint64_t fragments)
{
	return fragments <= gw_octree_most_fragments(work->gpu);
}

/* There are too many fragments: says so, and at which depth there aren't, where nobody tries. */
static gw_status fail_fragments(gw_octree_work *work, uint64_t fragments, gw_error *error)
{
	uint32_t depth = work->octree->depth, fitting = depth;
	uint64_t fewer = fragments, most = 4 * gw_octree_most_fragments(work->gpu);
	const char *device = gw_gpu_device(work->gpu)->name;
	if (work->too_many) {
		*work->too_many = fragments;
		return gw_fail(error, GW_ERROR_MEMORY,
					   "an octree of depth %u needs a list of %llu bytes, but \"%s\" binds at most "
					   "%llu",
					   depth, 4 * (unsigned long long)fragments, device, (unsigned long long)most);
	}
	while (--fitting > 0) {
		gw_octree_forget_upload(work);
		GW_TRY(gw_octree_upload(work, fitting, error));
		GW_TRY(gw_octree_count_fragments(work, &fewer, error));
		if (fragments_fit(work, fewer))
			return gw_fail(error, GW_ERROR_MEMORY,
						   "an octree of depth %u needs a list of %llu bytes, but \"%s\" binds at "
						   "most %llu: use a depth of %u or fewer points",
						   depth, 4 * (unsigned long long)fragments, device,
						   (unsigned long long)most, fitting);
	}
	return gw_fail(
		error, GW_ERROR_MEMORY,
		"an octree of depth %u needs a list of %llu bytes, but \"%s\" binds at most %llu: "
		"use fewer points; no depth is small enough",
		depth, 4 * (unsigned long long)fragments, device, (unsigned long long)most);
}

/* Fragments of work's some surfels; where those are all, keys become leaves at once. */
static gw_status make_fragments(gw_octree_work *work, gw_error *error)
{
	uint64_t fragments;
	GW_TRY(gw_octree_count_fragments(work, &fragments, error));
	if (!fragments_fit(work, fragments))
		return fail_fragments(work, fragments, error);
	work->octree->fragment_count = (uint32_t)fragments;
	GW_TRY(gw_octree_sort_fragments(work, error));
	if (work->kept == NULL)
		GW_TRY(gw_octree_find_leaves(work, error));
	return gw_octree_write_fragments(work, error);
}

/* The fragments of surfels that stay are made once; those of the others now. */
static gw_status make_kept_fragments(gw_octree_work *work, gw_error *error)
{
	gw_octree_kept *kept = work->kept;
	size_t still = work->still;
	gw_fragment_list moving = { 0 };
	gw_status status = GW_OK;
	if (kept->still.count == 0 && still > 0) {
		work->some = still;
		GW_TRY(make_fragments(work, error));
		GW_TRY(gw_octree_fetch_fragments(work, &kept->still, error));
	}
	work->from = still;
	work->some = work->surfels->count - still;
	if (work->some > 0)
		status = make_fragments(work, error);
	if (status == GW_OK && work->some > 0)
		status = gw_octree_fetch_fragments(work, &moving, error);
	if (status == GW_OK)
		status = gw_octree_merge_fragments(work, &kept->still, &moving, error);
	gw_fragment_list_clear(&moving);
	return status == GW_OK ? gw_octree_find_leaves(work, error) : status;
}

static gw_status build(gw_octree_work *work, uint32_t depth, gw_error *error)
{
	GW_TRY(gw_octree_upload(work, depth, error));
	if (work->kept != NULL)
		GW_TRY(make_kept_fragments(work, error));
	else
		GW_TRY(make_fragments(work, error));
	gw_octree_forget_discs(work);
	GW_TRY(gw_octree_make_tiles(work, error));
	GW_TRY(gw_octree_reduce_leaves(work, error));
	GW_TRY(gw_octree_upload_discs(work, error));
	return gw_octree_plant_discs(work, error);
}

static void destroy_work(gw_octree_work *work)
{
	gw_gpu *gpu = work->gpu;
	gw_buffer *buffer[] = {
		&work->surfel_albedo,     &work->surfel_bend, &work->surfel_emission, &work->surfel_offset,
		&work->surfel_samples,    &work->column_note, &work->fragment_place,  &work->marks,
		&work->fragment_centroid, &work->no_weight,   &work->first,           &work->seed,
		&work->ray_mark,          &work->distance,
	};
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		gw_buffer_destroy(gpu, buffer[i]);
	for (uint32_t t = 0; t <= GW_DEPTH_MAX; t++) {
		gw_buffer_destroy(gpu, &work->real[t]);
		gw_buffer_destroy(gpu, &work->parent[t]);
	}
	gw_sort_list_destroy(gpu, &work->keys);
	gw_sort_list_destroy(gpu, &work->list);
	gw_radix_sort_destroy(gpu, &work->sort);
	gw_passes_destroy(&work->passes);
}

/* Passes that are kept are lent to a build. */
static void borrow(gw_octree_work *work)
{
	work->passes = work->kept->passes;
	work->sort = work->kept->sort;
}

static void give_back(gw_octree_work *work)
{
	work->kept->passes = work->passes;
	work->kept->sort = work->sort;
	work->passes = (gw_passes){ 0 };
	work->sort = (gw_radix_sort){ 0 };
}

/* Of `start` are set: gpu, surfels, octree, regions, leaf_size, still and kept. */
static gw_status build_once(const gw_octree_work *start, uint32_t depth, gw_error *error)
{
	gw_octree_work work = *start;
	work.some = work.surfels->count;
	if (work.kept != NULL)
		borrow(&work);
	work.passes.gpu = work.gpu;
	gw_status status = build(&work, depth, error);
	if (work.kept != NULL)
		give_back(&work);
	destroy_work(&work);
	if (status != GW_OK)
		gw_octree_destroy(start->gpu, start->octree);
	return status;
}

static gw_status fail_count(const gw_surfels *surfels, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA, "an octree of %zu points: it can hold 1 to %u",
				   surfels->count, GW_FRAGMENT_SURFEL);
}

/* Notes why a build with leaves of a width was given up; the first one counts. */
static void note_coarser(double leaf_size, const gw_error *reason, float *wanted,
						 char why[GW_OCTREE_WHY])
{
	if (*wanted > 0.0f)
		return;
	*wanted = (float)leaf_size;
	snprintf(why, GW_OCTREE_WHY, "%.*s", GW_OCTREE_WHY - 1, reason->text);
}

/* How many times as wide leaves are to be tried next. Those that are wider by the root of 2 have
 * half of the fragments at least: a disc's are as many as the squares of leaves that it covers, and
 * some along its rim. So those that are too many still are not tried. */
static double widening(gw_gpu *gpu, uint64_t too_many)
{
	double width = M_SQRT2;
	for (uint64_t least = too_many / 2; least > gw_octree_most_fragments(gpu); least /= 2)
		width *= M_SQRT2;
	return width;
}

gw_status gw_octree_without_tree(gw_gpu *gpu, const gw_octree_task *task, gw_octree *octree,
								 gw_error *error)
{
	const gw_surfels *surfels = task->surfels;
	bool given = task->depth != GW_DEPTH_AUTO;
	double width = given ? 0.0 : leaf_size_of(task);
	gw_octree_work work = { .gpu = gpu, .surfels = surfels, .octree = octree, .leaf_size = width };
	memset(octree, 0, sizeof *octree);
	uint32_t depth = given ? task->depth : depth_of(extent_of(surfels) / width);
	gw_status status = gw_octree_upload_lit(&work, depth, error);
	if (status == GW_OK)
		octree->depth = 0;
	else
		gw_octree_destroy(gpu, octree);
	return status;
}

/* With leaves as wide as the start says, or as much wider as there is room for. */
static gw_status build_spaced(const gw_octree_work *start, gw_error *error)
{
	gw_octree_work work = *start;
	gw_octree *octree = work.octree;
	float wanted = 0.0f;
	uint64_t too_many;
	char why[GW_OCTREE_WHY] = "";
	work.too_many = &too_many;
	for (;;) {
		uint32_t depth = depth_of(extent_of(work.surfels) / work.leaf_size);
		too_many = 0;
		gw_status status = build_once(&work, depth, error);
		if (status == GW_OK) {
			octree->wanted_leaf_size = wanted;
			memcpy(octree->why_coarser, why, sizeof why);
		}
		if (status != GW_ERROR_MEMORY || depth == 1)
			return status;
		note_coarser(work.leaf_size, error, &wanted, why);
		work.leaf_size *= widening(work.gpu, too_many);
	}
}

gw_status gw_octree_build_task(gw_gpu *gpu, const gw_octree_task *task, gw_octree *octree,
							   gw_error *error)
{
	const gw_surfels *surfels = task->surfels;
	gw_octree_work start = {
		.gpu = gpu, .surfels = surfels, .octree = octree, .regions = task->regions
	};
	memset(octree, 0, sizeof *octree);
	if (task->depth > GW_DEPTH_MAX)
		return gw_fail(error, GW_ERROR_USAGE, "an octree of depth %u: it has to be 1 to %u",
					   task->depth, GW_DEPTH_MAX);
	if (surfels->count == 0 || surfels->count > GW_FRAGMENT_SURFEL)
		return fail_count(surfels, error);
	if (task->depth != GW_DEPTH_AUTO)
		return build_once(&start, task->depth, error);
	start.leaf_size = leaf_size_of(task);
	return build_spaced(&start, error);
}

gw_status gw_octree_build(gw_gpu *gpu, const gw_surfels *surfels, uint32_t depth, gw_octree *octree,
						  gw_error *error)
{
	const gw_octree_task task = {
		.surfels = surfels, .depth = depth, .leaf_spacing = GW_LEAF_SPACING, .regions = true
	};
	return gw_octree_build_task(gpu, &task, octree, error);
}

/* Builds with what is kept already, in the shape that was chosen then. */
static gw_status build_again(gw_octree_work *start, gw_error *error)
{
	start->leaf_size = start->kept->leaf_size;
	return build_once(start, start->kept->depth, error);
}

static gw_status build_first(gw_octree_work *start, const gw_octree_task *task, gw_error *error)
{
	const gw_surfels *surfels = start->surfels;
	gw_octree_kept *kept = start->kept;
	bool given = task->depth != GW_DEPTH_AUTO;
	kept->leaf_size = given ? 0 : leaf_size_of(task);
	for (;;) {
		kept->depth = given ? task->depth : depth_of(extent_of(surfels) / kept->leaf_size);
		gw_status status = build_again(start, error);
		if (status != GW_ERROR_MEMORY || given || kept->depth == 1)
			return status;
		gw_fragment_list_clear(&kept->still);
		note_coarser(kept->leaf_size, error, &kept->wanted_leaf_size, kept->why_coarser);
		kept->leaf_size *= widening(start->gpu, *start->too_many);
		*start->too_many = 0;
	}
}

gw_status gw_octree_build_kept(gw_gpu *gpu, const gw_octree_task *task, gw_octree_kept **kept,
							   gw_octree *octree, gw_error *error)
{
	const gw_surfels *surfels = task->surfels;
	memset(octree, 0, sizeof *octree);
	if (surfels->count == 0 || surfels->count > GW_FRAGMENT_SURFEL)
		return fail_count(surfels, error);
	bool first = *kept == NULL;
	if (first)
		*kept = gw_allocate_zeros(1, sizeof **kept);
	if (*kept == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to keep an octree's fragments");
	gw_octree_work start = { .gpu = gpu,
							 .surfels = surfels,
							 .octree = octree,
							 .regions = task->regions,
							 .still = task->still,
							 .kept = *kept };
	uint64_t too_many = 0;
	if (first && task->depth == GW_DEPTH_AUTO)
		start.too_many = &too_many;
	gw_status status = first ? build_first(&start, task, error) : build_again(&start, error);
	if (status == GW_OK) {
		octree->wanted_leaf_size = (*kept)->wanted_leaf_size;
		memcpy(octree->why_coarser, (*kept)->why_coarser, sizeof octree->why_coarser);
	} else if (first) {
		gw_octree_kept_destroy(gpu, kept);
	}
	return status;
}

void gw_octree_kept_destroy(gw_gpu *gpu, gw_octree_kept **kept)
{
	if (*kept == NULL)
		return;
	gw_fragment_list_clear(&(*kept)->still);
	gw_radix_sort_destroy(gpu, &(*kept)->sort);
	gw_passes_destroy(&(*kept)->passes);
	free(*kept);
	*kept = NULL;
}

void gw_octree_drop_neighbours(gw_gpu *gpu, gw_octree *octree)
{
	gw_buffer_destroy(gpu, &octree->tile_neighbour);
	gw_buffer_destroy(gpu, &octree->leaf_tile_neighbour);
}

void gw_octree_destroy(gw_gpu *gpu, gw_octree *octree)
{
	gw_buffer *buffer[] = {
		&octree->node,
		&octree->tile_key,
		&octree->tile_neighbour,
		&octree->leaf_tile_key,
		&octree->leaf_tile_neighbour,
		&octree->leaf_tile,
		&octree->leaf_cell,
		&octree->level_directory,
		&octree->ray_directory,
		&octree->leaf_geometry,
		&octree->facet_leaf,
		&octree->facet_plane,
		&octree->facet_centre,
		&octree->facet_albedo,
		&octree->facet_emission,
		&octree->leaf_fragment,
		&octree->fragment_surfel,
		&octree->fragment_weight,
		&octree->surfel_position,
		&octree->surfel_normal,
		&octree->surfel_disc,
		&octree->surfel_clip,
		&octree->disc_tree,
	};
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		gw_buffer_destroy(gpu, buffer[i]);
	gw_compartments_destroy(&octree->compartments);
	if (octree->coarser)
		gw_octree_destroy(gpu, octree->coarser);
	free(octree->coarser);
	free(octree->facet_compartment);
	memset(octree, 0, sizeof *octree);
}
