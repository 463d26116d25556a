/*
 * records.c - see records.h. Placement is on the CPU (record_places.c); listing by blocks, weights
 * and read-back are passes.
 */
#include "light/records.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "light/record_places.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Radius of influence when every facet is a record, leaf cells. */
#define RADIUS_DENSE 1.6f

/* By which records move together where they are too few: they become four times as many; and apart
 * where they are too many, at most to this. */
#define CLOSER 0.5f
#define SPACING_MOST 64.0f

/* Ends of a visibility test are moved this far off the surface, leaf cells: half a disc's radius.
 */
#define RAY_OFFSET 0.65f

static gw_status texel(gw_gpu *gpu, VkFormat format, uint64_t bytes, const char *name,
					   gw_buffer *buffer, gw_error *error)
{
	return gw_buffer_create(gpu, &(gw_buffer_description){ GW_BUFFER_TEXEL, format, bytes, name },
							buffer, error);
}

/* The level whose cells are at least so many radii wide: two are best where all lookups reach as
 * far as the radius, one where records were added and lookups are shorter. */
static void choose_blocks(const gw_octree *octree, float radii, gw_records *records)
{
	uint32_t up = (uint32_t)ceilf(log2f(radii * records->radius));
	records->block_level = octree->depth > up ? octree->depth - up : 0;
	if (records->block_level > octree->depth - 1)
		records->block_level = octree->depth - 1;
	if (records->block_level == octree->depth - 1) {
		records->block_tile_first = 0;
		records->block_count = octree->leaf_tile_count;
	} else {
		uint32_t level = records->block_level + 1;
		records->block_tile_first = octree->tile_first[level];
		records->block_count = octree->tile_first[level + 1] - octree->tile_first[level];
	}
}

gw_status gw_records_make_room(gw_gpu *gpu, gw_records *records, gw_error *error)
{
	gw_buffer *const buffer[] = { &records->first, &records->indirect, &records->gathered };
	const char *const name[] = { "record first irradiance", "record indirect irradiance",
								 "record gathered irradiance" };
	for (size_t i = 0; i < 3; i++)
		GW_TRY(texel(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, 16 * (uint64_t)records->count, name[i],
					 buffer[i], error));
	return GW_OK;
}

gw_status gw_records_make_moments(gw_gpu *gpu, gw_records *records, gw_error *error)
{
	gw_buffer *const buffer[] = { &records->first_moment, &records->indirect_moment };
	const char *const name[] = { "moment of first irradiance", "moment of indirect irradiance" };
	const uint64_t bytes = 32 * (uint64_t)records->count;
	for (size_t i = 0; i < 2; i++) {
		if (buffer[i]->handle != VK_NULL_HANDLE && buffer[i]->bytes == bytes)
			continue;
		gw_buffer_destroy(gpu, buffer[i]);
		GW_TRY(texel(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, bytes, name[i], buffer[i], error));
	}
	return GW_OK;
}

void gw_records_drop_moments(gw_gpu *gpu, gw_records *records)
{
	gw_buffer_destroy(gpu, &records->first_moment);
	gw_buffer_destroy(gpu, &records->indirect_moment);
}

/* Gives each facet that has area a row, in the order of facets. */
static void number_rows(const float *centre, size_t facets, uint32_t *row, uint32_t *count)
{
	*count = 1;
	for (size_t facet = 0; facet < facets; facet++)
		row[facet] = centre[4 * facet + 3] > 0.0f ? (*count)++ : 0;
}

/* Fills facet_row and row_count. */
static gw_status make_rows(gw_gpu *gpu, const gw_octree *octree, gw_records *records,
						   gw_error *error)
{
	size_t facets = octree->facet_count;
	gw_view centre;
	gw_edit row;
	GW_TRY(texel(gpu, VK_FORMAT_R32_UINT, 4 * (uint64_t)facets, "facet row", &records->facet_row,
				 error));
	GW_TRY(gw_view_open(gpu, &octree->facet_centre, 16 * (uint64_t)facets, &centre, error));
	gw_status status = gw_edit_open(gpu, &records->facet_row, &row, error);
	if (status == GW_OK) {
		number_rows(centre.bytes, facets, row.bytes, &records->row_count);
		status = gw_edit_close(gpu, &row, true, error);
	}
	gw_view_close(&centre);
	return status;
}

static gw_status create_buffers(gw_gpu *gpu, const gw_octree *octree, gw_records *records,
								gw_error *error)
{
	const VkFormat f4 = VK_FORMAT_R32G32B32A32_SFLOAT, u1 = VK_FORMAT_R32_UINT;
	if (records->facet_row.handle == VK_NULL_HANDLE)
		GW_TRY(make_rows(gpu, octree, records, error));
	uint64_t n = records->count, facets = records->row_count;
	const struct {
		gw_buffer *buffer;
		VkFormat format;
		uint64_t bytes;
		const char *name;
	} rows[] = {
		{ &records->position, f4, 16 * n, "record position" },
		{ &records->normal, f4, 16 * n, "record normal" },
		{ &records->block_first, u1, 4 * ((uint64_t)records->block_count + 1), "block first" },
		{ &records->block_record, u1, 4 * n, "block record" },
		{ &records->facet_record, VK_FORMAT_R32G32B32A32_UINT, 4 * GW_WEIGHTS * facets,
		  "facet record" },
		{ &records->facet_weight, f4, 4 * GW_WEIGHTS * facets, "facet weight" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (rows[i].buffer->handle == VK_NULL_HANDLE)
			GW_TRY(texel(gpu, rows[i].format, rows[i].bytes, rows[i].name, rows[i].buffer, error));
	return gw_records_make_room(gpu, records, error);
}

/* Puts a record on each of the facets that are listed. */
static gw_status put_on_facets(const gw_record_context *on, const gw_buffer *facet, gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(&on->octree->leaf_fragment),
									gw_whole(&on->octree->fragment_surfel),
									gw_whole(&on->octree->surfel_position),
									gw_whole(&on->octree->facet_plane),
									gw_whole(&on->octree->facet_centre),
									gw_window(facet, 4),
									gw_window(&on->records->position, 16),
									gw_window(&on->records->normal, 16),
									GW_LEAF_BINDING(on->octree) };
	return gw_passes_run(on->passes, GW_PASS_RECORD_PLACE, bindings, &(gw_record_push){ 0 },
						 on->records->count, error);
}

/* Counting sort of the records by block: block_first is where each block's list starts. False when
 * a record has none, which only a faulty device says. */
static bool sort_by_block(const uint32_t *block, uint32_t count, uint32_t block_count,
						  uint32_t *first, uint32_t *sorted)
{
	memset(first, 0, ((size_t)block_count + 1) * sizeof *first);
	for (uint32_t i = 0; i < count; i++) {
		if (block[i] >= block_count)
			return false;
		first[block[i] + 1]++;
	}
	for (uint32_t b = 0; b < block_count; b++)
		first[b + 1] += first[b];
	/* Backwards from each list's end, so that records stay in ascending order. */
	for (uint32_t i = count; i-- > 0;)
		sorted[--first[block[i] + 1]] = i;
	/* first[b + 1] has moved to the start of list b: move the starts into place. */
	for (uint32_t b = 0; b < block_count; b++)
		first[b] = first[b + 1];
	first[block_count] = count;
	return true;
}

/* Arrays of list_by_block. */
typedef struct block_lists {
	uint32_t *block;  /* of each record */
	uint32_t *sorted; /* records, block by block */
	uint32_t *first;  /* of each block, and the end of the last */
} block_lists;

static gw_status find_blocks(const gw_record_context *on, const gw_buffer *facet,
							 gw_buffer *block_of, uint32_t *block, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	uint64_t bytes = 4 * (uint64_t)on->records->count;
	GW_TRY(gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes, "record block" },
		block_of, error));
	const gw_binding bindings[] = { gw_whole(&on->octree->level_directory),
									gw_whole(&on->octree->node),
									gw_window(&on->records->position, 16),
									gw_window(block_of, 4),
									gw_window(facet, 4),
									gw_whole(&on->octree->leaf_cell),
									GW_LEAF_BINDING(on->octree) };
	gw_lookup_push push = { .block_level = on->records->block_level,
							.tile_first = on->records->block_tile_first };
	GW_TRY(gw_passes_run(on->passes, GW_PASS_RECORD_BLOCK, bindings, &push, on->records->count,
						 error));
	return gw_buffer_download(gpu, block_of, 0, block, bytes, error);
}

static gw_status fill_lists(const gw_record_context *on, const gw_buffer *facet,
							gw_buffer *block_of, const block_lists *lists, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	gw_records *r = on->records;
	if (!lists->block || !lists->sorted || !lists->first)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to list %u records", r->count);
	GW_TRY(find_blocks(on, facet, block_of, lists->block, error));
	if (!sort_by_block(lists->block, r->count, r->block_count, lists->first, lists->sorted))
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "the device found no place in the octree for some of %u records; update "
					   "its driver or choose another device",
					   r->count);
	GW_TRY(gw_buffer_upload(gpu, &r->block_first, 0, lists->first,
							4 * ((uint64_t)r->block_count + 1), error));
	return gw_buffer_upload(gpu, &r->block_record, 0, lists->sorted, 4 * (uint64_t)r->count, error);
}

static gw_status list_by_block(const gw_record_context *on, const gw_buffer *facet, gw_error *error)
{
	gw_buffer block_of = { 0 };
	const block_lists lists = { gw_allocate_array(on->records->count, sizeof *lists.block),
								gw_allocate_array(on->records->count, sizeof *lists.sorted),
								gw_allocate_array((size_t)on->records->block_count + 1,
												  sizeof *lists.first) };
	gw_status status = fill_lists(on, facet, &block_of, &lists, error);
	gw_buffer_destroy(on->passes->gpu, &block_of);
	free(lists.block);
	free(lists.sorted);
	free(lists.first);
	return status;
}

/* Centres and planes of both facets of each leaf, and albedos where some face either way. */
static gw_status view_facets(gw_gpu *gpu, const gw_octree *octree, gw_view view[3], gw_error *error)
{
	const gw_buffer *const buffer[3] = { &octree->facet_centre, &octree->facet_plane,
										 &octree->facet_albedo };
	for (int i = 0; i < (octree->backs ? 3 : 2); i++)
		GW_TRY(gw_view_open(gpu, buffer[i], 16 * (uint64_t)octree->facet_count, &view[i], error));
	return GW_OK;
}

/* Puts the records on their facets, and lists them. */
static gw_status put_and_list(const gw_record_context *on, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	gw_buffer facet = { 0 };
	uint64_t bytes = 4 * (uint64_t)on->records->count;
	GW_TRY(gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes, "record facet" },
		&facet, error));
	gw_status status = gw_buffer_upload(gpu, &facet, 0, on->records->facet, bytes, error);
	if (status == GW_OK)
		status = put_on_facets(on, &facet, error);
	if (status == GW_OK)
		status = list_by_block(on, &facet, error);
	gw_buffer_destroy(gpu, &facet);
	return status;
}

/* Throws darts; the chosen facets become records->facet and records->count. */
static gw_status choose_with(gw_place_task *task, gw_records *r, gw_error *error)
{
	size_t count = 0;
	free(r->facet);
	r->facet = NULL;
	r->spacing = task->spacing;
	r->radius = fmaxf(GW_FACET_REACH * task->spacing, RADIUS_DENSE);
	task->radius = r->radius;
	gw_status status = gw_place_records(task, &r->facet, &count, error);
	r->count = (uint32_t)count;
	return status;
}

/* Chooses facets until there are so many, or records stand as close as they may; or so few. */
static gw_status choose_spacing(gw_place_task *task, uint32_t least, gw_records *r, gw_error *error)
{
	GW_TRY(choose_with(task, r, error));
	while (r->count < least && task->spacing > GW_RECORD_SPACING_LEAST) {
		task->spacing = fmaxf(task->spacing * CLOSER, GW_RECORD_SPACING_LEAST);
		GW_TRY(choose_with(task, r, error));
	}
	while (task->most > 0 && r->count > task->most && task->spacing > 0.0f) {
		task->spacing = fminf(fmaxf(task->spacing / CLOSER, GW_RECORD_SPACING_LEAST), SPACING_MOST);
		if (task->spacing >= SPACING_MOST)
			task->most = 0;
		GW_TRY(choose_with(task, r, error));
	}
	return GW_OK;
}

/* The facets, and their order, are the same for all spacings. */
static gw_status choose_facets(const gw_record_context *on, gw_place_task task, uint32_t least,
							   gw_error *error)
{
	const gw_octree *octree = on->octree;
	gw_dart_order order = { 0 };
	gw_view view[3] = { 0 };
	task.facets = octree->facet_count;
	gw_status status = view_facets(on->passes->gpu, octree, view, error);
	task.centre = view[0].bytes;
	task.plane = view[1].bytes;
	task.albedo = view[2].bytes;
	if (status == GW_OK)
		status = gw_dart_order_make(&task, &order, error);
	task.order = &order;
	if (status == GW_OK)
		status = choose_spacing(&task, least, on->records, error);
	gw_dart_order_clear(&order);
	for (int i = 0; i < 3; i++)
		gw_view_close(&view[i]);
	return status;
}

/* What *records has of facet weights stays. */
static gw_status place(const gw_record_context *on, const gw_place_task *task, uint32_t least,
					   gw_error *error)
{
	gw_status status = choose_facets(on, *task, least, error);
	choose_blocks(on->octree, task->kept_count > 0 ? 1.0f : 2.0f, on->records);
	if (status == GW_OK)
		status = create_buffers(on->passes->gpu, on->octree, on->records, error);
	if (status == GW_OK && on->records->count > 0)
		status = put_and_list(on, error);
	if (status != GW_OK)
		gw_records_destroy(on->passes->gpu, on->records);
	return status;
}

/* What reading between records loses of one reflection is lost of all that follow: twice in all
 * where surface reflects half of its light, ten times where it reflects 0.95. So records of small
 * clouds are more where surface is whiter, in proportion, at most so many times as many: rooms of
 * 20,000 points at 0.95 and 0.98 are 0.08 % too dark, and were 0.5 %. */
#define WHITER_MOST 4.0

uint32_t gw_records_least(const gw_surfels *s, uint32_t asked)
{
	double albedo = 0.0, area = 0.0;
	for (size_t i = 0; i < s->count; i++) {
		albedo += (double)s->area[i] * gw_luminance(s->albedo + 3 * i);
		area += (double)s->area[i];
	}
	double lost = area > albedo ? 0.5 * area / (area - albedo) : WHITER_MOST;
	return (uint32_t)fmin(asked * fmin(fmax(lost, 1.0), WHITER_MOST), (double)UINT32_MAX);
}

gw_status gw_records_place(const gw_record_context *on, const gw_record_wish *wish, gw_error *error)
{
	const gw_place_task task = { .spacing = wish->spacing, .seed = wish->seed, .most = wish->most };
	*on->records = (gw_records){ 0 };
	return place(on, &task, wish->least, error);
}

gw_status gw_records_add(const gw_record_context *on, uint64_t seed, const float *facet_spacing,
						 gw_error *error)
{
	gw_place_task task = { .spacing = on->records->spacing,
						   .closer = facet_spacing,
						   .kept = on->records->facet,
						   .kept_count = on->records->count,
						   .seed = seed };
	gw_records more = { .row_count = on->records->row_count,
						.facet_row = on->records->facet_row,
						.facet_record = on->records->facet_record,
						.facet_weight = on->records->facet_weight };
	on->records->facet_row = on->records->facet_record = on->records->facet_weight =
		(gw_buffer){ 0 };
	gw_status status =
		place(&(gw_record_context){ on->passes, on->octree, &more }, &task, 0, error);
	gw_records_destroy(on->passes->gpu, on->records);
	*on->records = more;
	return status;
}

gw_status gw_records_put(gw_gpu *gpu, const float *position, const float *normal, uint32_t count,
						 gw_records *records, gw_error *error)
{
	*records = (gw_records){ .count = count };
	const struct {
		gw_buffer *buffer;
		const float *values;
		const char *name;
	} rows[] = {
		{ &records->position, position, "check point position" },
		{ &records->normal, normal, "check point normal" },
		{ &records->gathered, NULL, "check point gathered irradiance" },
	};
	uint64_t bytes = 16 * (uint64_t)count;
	gw_status status = GW_OK;
	for (size_t i = 0; i < sizeof rows / sizeof *rows && status == GW_OK; i++) {
		status =
			texel(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, bytes, rows[i].name, rows[i].buffer, error);
		if (status == GW_OK && rows[i].values)
			status = gw_buffer_upload(gpu, rows[i].buffer, 0, rows[i].values, bytes, error);
	}
	if (status != GW_OK)
		gw_records_destroy(gpu, records);
	return status;
}

void gw_records_destroy(gw_gpu *gpu, gw_records *records)
{
	gw_buffer *all[] = { &records->position,     &records->normal,       &records->block_first,
						 &records->block_record, &records->first,        &records->indirect,
						 &records->gathered,     &records->facet_record, &records->facet_weight,
						 &records->facet_row };
	gw_records_drop_moments(gpu, records);
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		gw_buffer_destroy(gpu, all[i]);
	free(records->facet);
	*records = (gw_records){ 0 };
}

gw_status gw_records_reach(gw_gpu *gpu, const gw_records *records, float reach,
						   const gw_own_spacings *own, gw_buffer *buffer, gw_error *error)
{
	size_t count = own->count;
	float *values = gw_allocate_array(count, sizeof *values);
	if (!values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu numbers", count);
	for (size_t i = 0; i < count; i++)
		values[i] = own->closer[i]
						? fminf(fmaxf(reach * own->spacing[i], RADIUS_DENSE), records->radius)
						: 0.0f;
	gw_status status =
		texel(gpu, VK_FORMAT_R32_SFLOAT, 4 * (uint64_t)count, "reach for records", buffer, error);
	if (status == GW_OK)
		status = gw_buffer_upload(gpu, buffer, 0, values, 4 * (uint64_t)count, error);
	free(values);
	return status;
}

static gw_lookup_push lookup(const gw_records *records, const gw_buffer *reach)
{
	return (gw_lookup_push){ .block_level = records->block_level,
							 .tile_first = records->block_tile_first,
							 .radius = records->radius,
							 .ray_offset = RAY_OFFSET,
							 .visibility = 1,
							 .own_reach = reach != NULL };
}

/* The first ten bindings of both lookups. */
#define LOOKUP_BINDINGS(on)                                                                        \
	GW_TRACE_BINDINGS((on)->octree), gw_whole(&(on)->octree->level_directory),                     \
		gw_whole(&(on)->records->position), gw_whole(&(on)->records->normal),                      \
		gw_whole(&(on)->records->block_first), gw_whole(&(on)->records->block_record)

/* The facet of each row; GW_NONE of the empty one. */
static gw_status list_facets(const gw_record_context *on, gw_buffer *facet, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	size_t facets = on->octree->facet_count;
	gw_view row;
	gw_edit edit;
	GW_TRY(texel(gpu, VK_FORMAT_R32_UINT, 4 * (uint64_t)on->records->row_count, "facets of rows",
				 facet, error));
	GW_TRY(gw_view_open(gpu, &on->records->facet_row, 4 * (uint64_t)facets, &row, error));
	gw_status status = gw_edit_open(gpu, facet, &edit, error);
	if (status == GW_OK) {
		for (size_t i = 0; i < facets; i++)
			((uint32_t *)edit.bytes)[((const uint32_t *)row.bytes)[i]] = (uint32_t)i;
		((uint32_t *)edit.bytes)[0] = GW_NONE;
		status = gw_edit_close(gpu, &edit, true, error);
	}
	gw_view_close(&row);
	return status;
}

static gw_status weigh_rows(const gw_record_context *on, const gw_buffer *reach,
							const gw_buffer *facet, gw_error *error)
{
	gw_lookup_push push = lookup(on->records, reach);
	const gw_binding bindings[] = { LOOKUP_BINDINGS(on),
									gw_window(&on->records->facet_record, 4 * GW_WEIGHTS),
									gw_window(&on->records->facet_weight, 4 * GW_WEIGHTS),
									gw_whole(reach ? reach : &on->records->position),
									GW_TREE_BINDING(on->octree),
									gw_window(facet, 4) };
	return gw_passes_run(on->passes, GW_PASS_FACET_WEIGHTS, bindings, &push, on->records->row_count,
						 error);
}

gw_status gw_records_weigh_facets(const gw_record_context *on, const gw_buffer *reach,
								  gw_error *error)
{
	gw_buffer facet = { 0 };
	GW_TRY(gw_buffer_own(on->passes->gpu, &on->records->facet_record, error));
	GW_TRY(gw_buffer_own(on->passes->gpu, &on->records->facet_weight, error));
	gw_status status = list_facets(on, &facet, error);
	if (status == GW_OK)
		status = weigh_rows(on, reach, &facet, error);
	gw_buffer_destroy(on->passes->gpu, &facet);
	return status;
}

gw_status gw_records_weigh_surfels(const gw_record_context *on, const gw_buffer *reach,
								   const gw_surfel_rows *rows, gw_error *error)
{
	gw_lookup_push push = lookup(on->records, reach);
	push.surfel_first = (uint32_t)rows->first;
	const gw_binding bindings[] = { LOOKUP_BINDINGS(on),
									gw_whole(&on->octree->surfel_position),
									gw_whole(&on->octree->surfel_normal),
									gw_window(&rows->record, 4 * GW_SURFEL_WEIGHTS),
									gw_window(&rows->weight, 4 * GW_SURFEL_WEIGHTS),
									gw_whole(reach ? reach : &on->records->position),
									GW_TREE_BINDING(on->octree) };
	return gw_passes_run(on->passes, GW_PASS_READ_BACK, bindings, &push, rows->count, error);
}

gw_status gw_records_light(gw_gpu *gpu, const gw_records *records, double *light, gw_error *error)
{
	const gw_buffer *parts[2] = { &records->first, &records->indirect };
	float *values = gw_allocate_array(records->count, 4 * sizeof *values);
	gw_status status = GW_OK;
	if (!values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", records->count);
	for (size_t k = 0; k < 2 && status == GW_OK; k++) {
		status = gw_buffer_download(gpu, parts[k], 0, values, 16 * (uint64_t)records->count, error);
		for (size_t i = 0; i < records->count && status == GW_OK; i++)
			light[i] = (k ? light[i] : 0.0) + gw_luminance(values + 4 * i);
	}
	free(values);
	return status;
}
