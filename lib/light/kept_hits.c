/*
 * kept_hits.c - see kept_hits.h.
 */
#include "light/kept_hits.h"

#include "base/memory.h"
#include "light/transport_layout.h"

#include <stdlib.h>
#include <string.h>

static gw_buffer *writable(const gw_buffer *buffer)
{
	return (gw_buffer *)(uintptr_t)buffer;
}

/* Positions and normals of records, 6 floats each, for free(). */
static gw_status fetch_places(gw_gpu *gpu, const gw_records *records, float **place,
							  gw_error *error)
{
	size_t n = records->count;
	float *position = gw_allocate_array(n, 4 * sizeof *position);
	float *normal = gw_allocate_array(n, 4 * sizeof *normal);
	*place = gw_allocate_array(n, 6 * sizeof **place);
	gw_status status = GW_OK;
	if (!position || !normal || !*place)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", n);
	if (status == GW_OK)
		status = gw_buffer_download(gpu, writable(&records->position), 0, position, 16 * n, error);
	if (status == GW_OK)
		status = gw_buffer_download(gpu, writable(&records->normal), 0, normal, 16 * n, error);
	for (size_t i = 0; i < n && status == GW_OK; i++) {
		memcpy(*place + 6 * i, position + 4 * i, 12);
		memcpy(*place + 6 * i + 3, normal + 4 * i, 12);
	}
	free(position);
	free(normal);
	if (status != GW_OK) {
		free(*place);
		*place = NULL;
	}
	return status;
}

/* Of each facet but the empty one twice the Morton key of its leaf, plus 1 for a second one:
 * ascending, for free(). */
static gw_status fetch_facets(gw_gpu *gpu, const gw_octree *octree, uint64_t **key, gw_error *error)
{
	size_t n = octree->facet_count - 1;
	gw_view cell = { 0 }, leaf = { 0 };
	*key = gw_allocate_array(n, sizeof **key);
	gw_status status =
		*key ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu facets", n);
	if (status == GW_OK)
		status =
			gw_view_open(gpu, &octree->leaf_cell, 16 * (uint64_t)octree->leaf_count, &cell, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->facet_leaf, 4 * ((uint64_t)n + 1), &leaf, error);
	for (size_t i = 0; i < n && status == GW_OK; i++) {
		uint32_t word = ((const uint32_t *)leaf.bytes)[GW_FACET_EMPTY + 1 + i];
		const uint32_t *at = (const uint32_t *)cell.bytes + 4 * gw_facet_leaf(word);
		(*key)[i] = 2 * gw_morton_encode(at[0], at[1], at[2]) + gw_facet_is_second(word);
	}
	gw_view_close(&leaf);
	gw_view_close(&cell);
	if (status != GW_OK) {
		free(*key);
		*key = NULL;
	}
	return status;
}

/* ------------------------------------------------------------------------ the hash of records */

static uint32_t hash_place(const float place[6])
{
	uint32_t word[6];
	uint64_t sum = 0;
	memcpy(word, place, sizeof word);
	for (int i = 0; i < 6; i++)
		sum = (sum ^ word[i]) * 0x9e3779b97f4a7c15u;
	return (uint32_t)(sum >> 32);
}

static bool list_records(gw_kept_hits *kept)
{
	kept->mask = 1;
	while (kept->mask / 2 < kept->record_count && kept->mask < UINT32_MAX / 2)
		kept->mask = kept->mask * 2 + 1;
	kept->bucket = gw_allocate_zeros((size_t)kept->mask + 1, sizeof *kept->bucket);
	if (!kept->bucket)
		return false;
	for (uint32_t i = 0; i < kept->record_count; i++) {
		uint32_t at = hash_place(kept->place + 6 * (size_t)i) & kept->mask;
		while (kept->bucket[at] != 0)
			at = (at + 1) & kept->mask;
		kept->bucket[at] = i + 1;
	}
	return true;
}

static uint32_t find_record(const gw_kept_hits *kept, const float place[6])
{
	uint32_t at = hash_place(place) & kept->mask;
	for (; kept->bucket[at] != 0; at = (at + 1) & kept->mask)
		if (memcmp(kept->place + 6 * (size_t)(kept->bucket[at] - 1), place, 24) == 0)
			return kept->bucket[at] - 1;
	return GW_NONE;
}

static gw_status take(gw_gpu *gpu, const gw_octree *octree, const gw_records *records,
					  gw_kept_hits *kept, gw_error *error)
{
	GW_TRY(fetch_places(gpu, records, &kept->place, error));
	GW_TRY(fetch_facets(gpu, octree, &kept->facet_key, error));
	if (!list_records(kept))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", records->count);
	return GW_OK;
}

gw_status gw_kept_hits_take(gw_gpu *gpu, const gw_octree *octree, const gw_records *records,
							gw_ray_gather *rays, gw_kept_hits *kept, gw_error *error)
{
	*kept = (gw_kept_hits){ .record_count = records->count, .facet_count = octree->facet_count };
	gw_status status = take(gpu, octree, records, kept, error);
	if (status != GW_OK) {
		gw_kept_hits_destroy(gpu, kept);
		return status;
	}
	kept->rays = *rays;
	*rays = (gw_ray_gather){ 0 };
	return GW_OK;
}

void gw_kept_hits_destroy(gw_gpu *gpu, gw_kept_hits *kept)
{
	gw_ray_gather_destroy(gpu, &kept->rays);
	free(kept->place);
	free(kept->bucket);
	free(kept->facet_key);
	*kept = (gw_kept_hits){ 0 };
}

/* ------------------------------------------------------------------------------------- tracing */

/* What goes to the device for one frame. */
typedef struct keep_tables {
	gw_buffer known_record, facet_now, box, list;
	uint32_t box_count;
} keep_tables;

static gw_status upload(gw_gpu *gpu, const gw_buffer_description *description, const void *values,
						gw_buffer *buffer, gw_error *error)
{
	GW_TRY(gw_buffer_create(gpu, description, buffer, error));
	return gw_buffer_upload(gpu, buffer, 0, values, description->bytes, error);
}

static gw_status match_records(gw_gpu *gpu, const gw_records *records, const gw_kept_hits *kept,
							   keep_tables *tables, gw_error *error)
{
	float *place = NULL;
	uint32_t *known = gw_allocate_array(records->count, sizeof *known);
	gw_status status =
		known ? fetch_places(gpu, records, &place, error)
			  : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", records->count);
	for (uint32_t i = 0; i < records->count && status == GW_OK; i++)
		known[i] = find_record(kept, place + 6 * (size_t)i);
	if (status == GW_OK)
		status =
			upload(gpu,
				   &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
											 4 * (uint64_t)records->count, "records known before" },
				   known, &tables->known_record, error);
	free(place);
	free(known);
	return status;
}

/* What facets are now, of which both orders are ascending. All old leaves are among the new ones,
 * but a second facet may be gone where something moved in: then it is the empty one, and rays that
 * met it are traced again. False where a leaf is gone. */
static bool match_keys(const gw_kept_hits *kept, const uint64_t *key, uint32_t count, uint32_t *now)
{
	uint32_t at = 0;
	for (uint32_t i = 0; i + 1 < kept->facet_count; i++) {
		while (at + 2 < count && key[at] < kept->facet_key[i])
			at++;
		now[GW_FACET_EMPTY + 1 + i] =
			key[at] == kept->facet_key[i] ? GW_FACET_EMPTY + 1 + at : GW_FACET_EMPTY;
		if (key[at] != kept->facet_key[i] && kept->facet_key[i] % 2 == 0)
			return false;
	}
	now[GW_FACET_EMPTY] = GW_FACET_EMPTY;
	return true;
}

static gw_status match_facets(gw_gpu *gpu, const gw_octree *octree, const gw_kept_hits *kept,
							  keep_tables *tables, gw_error *error)
{
	uint64_t *key = NULL;
	uint32_t *now = gw_allocate_array(kept->facet_count, sizeof *now);
	gw_status status =
		now ? fetch_facets(gpu, octree, &key, error)
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for %u facets", kept->facet_count);
	if (status == GW_OK && !match_keys(kept, key, octree->facet_count, now))
		status = gw_fail(error, GW_ERROR_INTERNAL, "a leaf that stood still is gone");
	if (status == GW_OK)
		status = upload(gpu,
						&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
												  4 * (uint64_t)kept->facet_count,
												  "facets as they are now" },
						now, &tables->facet_now, error);
	free(key);
	free(now);
	return status;
}

static gw_status keep(const gw_record_context *on, const gw_kept_hits *kept,
					  const keep_tables *tables, gw_ray_gather *gather, gw_error *error)
{
	const gw_binding bindings[] = {
		gw_whole(&kept->rays.facet),      gw_whole(&kept->rays.distance),
		gw_whole(&tables->known_record),  gw_whole(&tables->facet_now),
		gw_whole(&on->records->position), gw_whole(&on->records->normal),
		gw_whole(&tables->box),           gw_window(&gather->facet, 4),
		gw_window(&gather->distance, 4),  gw_whole(&tables->list)
	};
	gw_keep_push push = { .rays = gather->rays, .seed = gather->seed, .boxes = tables->box_count };
	return gw_passes_run(on->passes, GW_PASS_RECORD_KEEP, bindings, &push,
						 (uint64_t)gather->rays * on->records->count, error);
}

static gw_status trace_listed(const gw_record_context *on, const keep_tables *tables,
							  gw_ray_gather *gather, uint64_t *traced, gw_error *error)
{
	uint32_t listed;
	GW_TRY(gw_buffer_download(on->passes->gpu, writable(&tables->list), 0, &listed, 4, error));
	*traced = listed;
	const gw_binding bindings[] = {
		GW_TRACE_BINDINGS(on->octree),  gw_whole(&on->records->position),
		gw_whole(&on->records->normal), gw_whole(&tables->list),
		gw_whole(&gather->facet),       gw_whole(&gather->distance),
		GW_DISC_BINDINGS(on->octree),   GW_TREE_BINDING(on->octree),
		GW_OPACITY_BINDING(on->octree), GW_LEAF_BINDING(on->octree)
	};
	gw_keep_push push = { .rays = gather->rays, .seed = gather->seed };
	return gw_passes_run(on->passes, GW_PASS_RECORD_AGAIN, bindings, &push, listed, error);
}

static gw_status make_tables(const gw_record_context *on, const gw_kept_hits *kept,
							 gw_changed_boxes boxes, keep_tables *tables, gw_error *error)
{
	tables->box_count = boxes.count;
	uint64_t rays = (uint64_t)kept->rays.rays * on->records->count;
	GW_TRY(match_records(on->passes->gpu, on->records, kept, tables, error));
	GW_TRY(match_facets(on->passes->gpu, on->octree, kept, tables, error));
	GW_TRY(upload(on->passes->gpu,
				  &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
											sizeof *boxes.box * (uint64_t)boxes.count,
											"changed boxes" },
				  boxes.box, &tables->box, error));
	return gw_buffer_create(on->passes->gpu,
							&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
													  4 * (rays + 1), "rays to trace again" },
							&tables->list, error);
}

static gw_status trace_again(const gw_record_context *on, const gw_kept_hits *kept,
							 gw_changed_boxes boxes, gw_ray_gather *gather, uint64_t *traced,
							 gw_error *error)
{
	keep_tables tables = { 0 };
	gw_status status = make_tables(on, kept, boxes, &tables, error);
	if (status == GW_OK)
		status = keep(on, kept, &tables, gather, error);
	if (status == GW_OK)
		status = trace_listed(on, &tables, gather, traced, error);
	gw_buffer_destroy(on->passes->gpu, &tables.known_record);
	gw_buffer_destroy(on->passes->gpu, &tables.facet_now);
	gw_buffer_destroy(on->passes->gpu, &tables.box);
	gw_buffer_destroy(on->passes->gpu, &tables.list);
	return status;
}

gw_status gw_kept_hits_trace(const gw_record_context *on, const gw_kept_hits *kept,
							 gw_changed_boxes boxes, gw_ray_gather *gather, uint64_t *traced,
							 gw_error *error)
{
	uint64_t rays = (uint64_t)kept->rays.rays * on->records->count;
	/* Lists that are too long to be bound as a whole; and backs that are dark. */
	if (on->octree->dark_facet != 0 ||
		4 * (rays + 1) > gw_gpu_limits(on->passes->gpu)->maxStorageBufferRange) {
		*traced = rays;
		return gw_ray_gather_trace(on, kept->rays.rays, kept->rays.seed, gather, error);
	}
	GW_TRY(gw_ray_gather_create(on->passes->gpu, on->records, kept->rays.rays, kept->rays.seed,
								gather, error));
	gw_status status = trace_again(on, kept, boxes, gather, traced, error);
	if (status != GW_OK)
		gw_ray_gather_destroy(on->passes->gpu, gather);
	return status;
}
