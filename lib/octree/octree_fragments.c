/*
 * octree_fragments.c - surfels in grid coordinates, and the leaves that each contributes to; see
 * octree_steps.h.
 */
#include "octree/octree_steps.h"

#include "base/memory.h"
#include "cloud/frame.h"
#include "octree/trace_constants.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Arrays of surfels on the device, as upload_arrays lists them: all; those that fragments are made
 * of, which come first, and colours after them; and of these those that lamps light. */
#define SURFEL_ARRAYS 7
#define PLACE_ARRAYS 5
#define LIT_ARRAYS 2
#define DISC_ARRAYS 4 /* those of discs come after what lamps light */

/* Surfels converted at once. */
#define UPLOAD_SURFELS 65536u

/* The least RoI; keeps shares of it finite. */
#define ROI_MIN 1e-6f

/* Discs in leaf cells and their areas in leaf cells^2: no more than what keeps squares within
 * float32; and less than the least would leave its range when means are divided by it. */
#define RADIUS_MAX 1e12
#define AREA_MAX 1e24
#define AREA_MIN 1e-12

static float larger(float a, float b)
{
	return a > b ? a : b;
}

/*
 * The cube's side is 2^depth leaf cells, of which two (a quarter of the side, if that is less) on
 * each side are left free for regions of influence, discs and border tiles. Leaves are as small as
 * that allows, but at least leaf_size metres wide.
 */
static void choose_cube(const gw_surfels *surfels, double leaf_size, gw_octree *octree)
{
	double side = (double)(1u << octree->depth), margin = fmin(2, side / 4), extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)surfels->maximum[k] - (double)surfels->minimum[k]);
	/* One point: its piece of surface is about a cell. */
	if (!(extent > 0))
		extent = (surfels->spacing > 0 ? (double)surfels->spacing : 1) * (side - 2 * margin);
	/* A little larger, so that rounding keeps the margin. */
	octree->leaf_size = (float)(extent / (side - 2 * margin) * (1 + 1e-5));
	octree->leaf_size = larger(octree->leaf_size, larger((float)leaf_size, FLT_MIN));
	for (int k = 0; k < 3; k++) {
		double middle = 0.5 * ((double)surfels->minimum[k] + (double)surfels->maximum[k]);
		octree->cube_minimum[k] = (float)(middle - 0.5 * side * (double)octree->leaf_size);
	}
	octree->directory_level =
		octree->depth - 1 < GW_DIRECTORY_LEVEL_MAX ? octree->depth - 1 : GW_DIRECTORY_LEVEL_MAX;
}

/* What a surfel's normal carries besides: gw_octree.surfel_normal. */
static float mark_of(const gw_surfels *s, size_t i)
{
	static const float of_sides[] = { 0, 1, GW_MARK_UNCLEAR, GW_MARK_BACK, GW_MARK_FOLIAGE };
	assert(GW_FOLIAGE_TRANSPARENCY == GW_FOLIAGE_CLEAR);
	if (s->two_sided[i])
		return of_sides[s->two_sided[i] % (sizeof of_sides / sizeof *of_sides)];
	return s->creased && s->creased[i] ? GW_MARK_CREASED : 0;
}

/* Converts one surfel's `k`-th array of what goes to the device. */
static void convert(const gw_octree *octree, const gw_surfels *s, size_t i, int which, float out[4])
{
	double leaf = (double)octree->leaf_size;
	const float *clip = s->clip + 6 * i;
	float to_cells = (float)(1 / leaf);
	switch (which) {
	case 0:
		for (int k = 0; k < 3; k++)
			out[k] =
				(float)(((double)s->position[3 * i + (size_t)k] - (double)octree->cube_minimum[k]) /
						leaf);
		out[3] = (float)fmin(1, (double)s->nearest[i] / leaf);
		out[3] = larger(out[3], ROI_MIN);
		break;
	case 1:
		for (int k = 0; k < 3; k++)
			out[k] = s->normal[3 * i + (size_t)k];
		out[3] = mark_of(s, i);
		break;
	case 2:
		out[0] = (float)fmin(RADIUS_MAX, (double)s->radius[i] / leaf);
		out[1] = (float)fmin(AREA_MAX, fmax(AREA_MIN, (double)s->area[i] / (leaf * leaf)));
		out[2] = clip[0];
		out[3] = clip[1];
		break;
	case 3:
		out[0] = clip[2] * to_cells;
		out[1] = clip[3];
		out[2] = clip[4];
		out[3] = clip[5] * to_cells;
		break;
	case 4:
		for (int k = 0; k < 3; k++)
			out[k] = s->bend ? (float)((double)s->bend[3 * i + (size_t)k] * leaf) : 0;
		out[3] = 0;
		break;
	default:
		for (int k = 0; k < 3; k++)
			out[k] = (which == 5 ? s->albedo : s->emission)[3 * i + (size_t)k];
		out[3] = which == 5 && s->transparency ? s->transparency[i] : 0;
	}
}

static gw_status upload_array(gw_octree_work *work, int which, gw_buffer *buffer, float *chunk,
							  gw_error *error)
{
	const gw_surfels *s = work->surfels;
	for (size_t first = 0; first < s->count; first += UPLOAD_SURFELS) {
		size_t count = s->count - first < UPLOAD_SURFELS ? s->count - first : UPLOAD_SURFELS;
		for (size_t i = 0; i < count; i++)
			convert(work->octree, s, first + i, which, chunk + 4 * i);
		GW_TRY(gw_buffer_upload(work->gpu, buffer, 16 * (uint64_t)first, chunk, 16 * count, error));
	}
	return GW_OK;
}

/* The arrays of surfels first..last-1, through a chunk of UPLOAD_SURFELS at most. */
static gw_status upload_through(gw_octree_work *work, int first, int last, float *chunk,
								gw_error *error)
{
	gw_octree *octree = work->octree;
	const struct {
		gw_buffer *buffer;
		const char *name;
	} array[] = {
		{ &octree->surfel_position, "surfel positions" },
		{ &octree->surfel_normal, "surfel normals" },
		{ &octree->surfel_disc, "surfel discs" },
		{ &octree->surfel_clip, "surfel clips" },
		{ &work->surfel_bend, "surfel bends" },
		{ &work->surfel_albedo, "surfel albedos" },
		{ &work->surfel_emission, "surfel emission" },
	};
	uint64_t bytes = 16 * (uint64_t)work->surfels->count;
	for (int i = first; i < last; i++) {
		bool there = i < 6 || gw_surfels_emit(work->surfels);
		if (!there) {
			GW_TRY(gw_octree_buffer(work, VK_FORMAT_R32G32B32A32_SFLOAT, 16, array[i].name,
									array[i].buffer, error));
			continue;
		}
		GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32G32B32A32_SFLOAT, bytes, array[i].name,
									  array[i].buffer, error));
		GW_TRY(upload_array(work, i, array[i].buffer, chunk, error));
	}
	return GW_OK;
}

static gw_status upload_arrays(gw_octree_work *work, int first, int last, gw_error *error)
{
	size_t count = work->surfels->count;
	float *chunk =
		gw_allocate_array(count < UPLOAD_SURFELS ? count : UPLOAD_SURFELS, 4 * sizeof *chunk);
	if (chunk == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "not enough memory to upload %zu points", count);
	gw_status status = upload_through(work, first, last, chunk, error);
	free(chunk);
	return status;
}

/* Surfels to the device, in an octree of a depth. */
static gw_status upload(gw_octree_work *work, uint32_t depth, int arrays, gw_error *error)
{
	const gw_surfels *s = work->surfels;
	work->octree->depth = depth;
	choose_cube(s, work->leaf_size, work->octree);
	work->octree->backs = memchr(s->two_sided, GW_SIDE_BACK, s->count) != NULL;
	return upload_arrays(work, 0, arrays, error);
}

gw_status gw_octree_upload(gw_octree_work *work, uint32_t depth, gw_error *error)
{
	return upload(work, depth, PLACE_ARRAYS, error);
}

gw_status gw_octree_upload_colours(gw_octree_work *work, gw_error *error)
{
	return upload_arrays(work, PLACE_ARRAYS, SURFEL_ARRAYS, error);
}

void gw_octree_forget_discs(gw_octree_work *work)
{
	gw_buffer_destroy(work->gpu, &work->octree->surfel_disc);
	gw_buffer_destroy(work->gpu, &work->octree->surfel_clip);
}

gw_status gw_octree_upload_discs(gw_octree_work *work, gw_error *error)
{
	return upload_arrays(work, LIT_ARRAYS, DISC_ARRAYS, error);
}

gw_status gw_octree_upload_lit(gw_octree_work *work, uint32_t depth, gw_error *error)
{
	return upload(work, depth, LIT_ARRAYS, error);
}

void gw_octree_forget_upload(gw_octree_work *work)
{
	gw_buffer *buffer[] = {
		&work->octree->surfel_position, &work->octree->surfel_normal, &work->octree->surfel_disc,
		&work->octree->surfel_clip,     &work->surfel_bend,           &work->surfel_offset,
		&work->surfel_samples,          &work->column_note,           &work->no_weight
	};
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		gw_buffer_destroy(work->gpu, buffer[i]);
}

bool gw_octree_is_wide(const gw_octree_work *work)
{
	return 3 * work->octree->depth > 32;
}

/* What is not written is stood in for. */
static gw_status run_fragments(gw_octree_work *work, uint32_t emit, gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_buffer *stand_in = &work->surfel_offset;
	bool keys = emit == GW_EMIT_KEYS, rest = emit == GW_EMIT_REST, wide = gw_octree_is_wide(work);
	gw_fragments_push push = { .side = 1u << octree->depth,
							   .emit = emit,
							   .wide = wide,
							   .base = (uint32_t)work->from,
							   .disc_most = gw_octree_disc_most(work->surfels),
							   .regions = work->regions };
	gw_binding bindings[] = {
		GW_WHOLE(&octree->surfel_position),
		GW_WHOLE(&octree->surfel_normal),
		GW_WHOLE(&octree->surfel_disc),
		GW_WHOLE(&octree->surfel_clip),
		GW_WHOLE(&work->surfel_bend),
		GW_WINDOW(&work->surfel_offset, 4),
		GW_WINDOW(&work->surfel_samples, 4),
		GW_WHOLE(rest ? &work->fragment_place : stand_in),
		GW_WHOLE(keys   ? &work->keys.low
				 : rest ? &octree->fragment_surfel
						: stand_in),
		GW_WHOLE(keys && wide ? &work->keys.high
				 : rest       ? &work->fragment_centroid
							  : stand_in),
		GW_WHOLE(rest ? &octree->fragment_weight : &work->no_weight),
		rest ? GW_WHOLE(stand_in) : GW_WINDOW(&work->column_note, 4 * GW_COLUMN_WORDS),
	};
	return gw_passes_run(&work->passes, GW_PASS_OCTREE_FRAGMENTS, bindings, &push, work->some,
						 error);
}

gw_status gw_octree_count_fragments(gw_octree_work *work, uint64_t *total, gw_error *error)
{
	uint64_t bytes = 4 * (uint64_t)work->some;
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, bytes, "fragments of surfels",
								  &work->surfel_offset, error));
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, bytes, "samples of discs",
								  &work->surfel_samples, error));
	const gw_buffer_description notes = { GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
										  GW_COLUMN_WORDS * bytes, "what discs meet" };
	GW_TRY(gw_buffer_create_unset(work->gpu, &notes, &work->column_note, error));
	if (work->no_weight.handle == VK_NULL_HANDLE)
		GW_TRY(
			gw_octree_buffer(work, VK_FORMAT_R32_SFLOAT, 4, "no weight", &work->no_weight, error));
	GW_TRY(run_fragments(work, GW_EMIT_COUNTS, error));
	return gw_prefix_sum_run(&work->passes, &work->sort.prefix, &work->surfel_offset, work->some,
							 total, error);
}

/* Where each key went, in place of what sorting has no more use for. */
static gw_status find_places(gw_octree_work *work, gw_error *error)
{
	gw_sort_list *keys = &work->keys;
	gw_binding bindings[] = { GW_WINDOW(&keys->payload, 4), GW_WHOLE(&keys->payload_copy) };
	GW_TRY(gw_passes_run(&work->passes, GW_PASS_OCTREE_INVERT, bindings, &(gw_keys_push){ 0 },
						 work->octree->fragment_count, error));
	work->fragment_place = keys->payload_copy;
	work->fragment_place.name = "places of fragments";
	keys->payload_copy = (gw_buffer){ 0 };
	gw_sort_list_trim(work->gpu, keys);
	gw_buffer_destroy(work->gpu, &keys->payload);
	return GW_OK;
}

gw_status gw_octree_sort_fragments(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	GW_TRY(gw_sort_list_create(work->gpu, octree->fragment_count, gw_octree_is_wide(work),
							   &work->keys, error));
	GW_TRY(run_fragments(work, GW_EMIT_KEYS, error));
	gw_buffer_destroy(work->gpu, &work->column_note);
	GW_TRY(gw_radix_sort_run(&work->passes, &work->sort, &work->keys, 3 * octree->depth, error));
	return find_places(work, error);
}

gw_status gw_octree_write_fragments(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint64_t bytes = 4 * (uint64_t)octree->fragment_count;
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, bytes, "surfels of fragments",
								  &octree->fragment_surfel, error));
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_SFLOAT, bytes, "weights of fragments",
								  &octree->fragment_weight, error));
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, bytes, "centroids of fragments",
								  &work->fragment_centroid, error));
	GW_TRY(run_fragments(work, GW_EMIT_REST, error));
	gw_buffer_destroy(work->gpu, &work->surfel_offset);
	gw_buffer_destroy(work->gpu, &work->surfel_samples);
	gw_buffer_destroy(work->gpu, &work->fragment_place);
	return GW_OK;
}
