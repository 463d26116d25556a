/*
 * octree_cells.c - see glowworm_picture.h.
 */
#include "picture/render_octree.h"

#include "base/memory.h"
#include "base/sorted_keys.h"
#include "device/passes.h"

#include <stdlib.h>

static int compare_keys(const void *a, const void *b)
{
	const uint64_t *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

/* Sorts, and keeps one of each. */
static size_t sort_unique(uint64_t *key, size_t count)
{
	size_t kept = 0;
	qsort(key, count, sizeof *key, compare_keys);
	for (size_t i = 0; i < count; i++)
		if (kept == 0 || key[kept - 1] != key[i])
			key[kept++] = key[i];
	return kept;
}

static void set_size(const gw_octree *t, uint32_t level, gw_cells *cells)
{
	cells->size = t->leaf_size * (float)(1u << (t->depth - level));
	for (int k = 0; k < 3; k++)
		cells->corner[k] = t->cube_minimum[k];
}

static gw_status check_level(const gw_octree *t, uint32_t level, gw_error *error)
{
	if (level >= 1 && level <= t->depth)
		return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE, "there is no level %u; the octree's go from 1 to %u",
				   level, t->depth);
}

/* Keys of the cells of a level that hold leaves; freed by the caller. */
static gw_status keys_of_leaves(gw_render_octree *o, uint32_t level, uint64_t **keys, size_t *count,
								gw_error *error)
{
	const gw_octree *t = &o->octree;
	uint32_t *leaf = gw_allocate_array(t->leaf_count, 4 * sizeof *leaf);
	*keys = gw_allocate_array(t->leaf_count, sizeof **keys);
	*count = 0;
	gw_status status =
		leaf && *keys ? GW_OK
					  : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u cells", t->leaf_count);
	if (status == GW_OK)
		status = gw_buffer_download(o->gpu, &o->octree.leaf_cell, 0, leaf,
									16 * (uint64_t)t->leaf_count, error);
	for (size_t i = 0; i < t->leaf_count && status == GW_OK; i++)
		(*keys)[i] = gw_morton_encode(leaf[4 * i], leaf[4 * i + 1], leaf[4 * i + 2]) >>
					 3 * (t->depth - level);
	if (status == GW_OK)
		*count = sort_unique(*keys, t->leaf_count);
	free(leaf);
	if (status != GW_OK) {
		free(*keys);
		*keys = NULL;
	}
	return status;
}

gw_status gw_cells_list(gw_render_octree *o, uint32_t level, gw_cells *cells, gw_error *error)
{
	*cells = (gw_cells){ .count = 0 };
	GW_TRY(check_level(&o->octree, level, error));
	set_size(&o->octree, level, cells);
	return keys_of_leaves(o, level, &cells->key, &cells->count, error);
}

/* Keys of all tiles of a level; freed by the caller. */
static gw_status keys_of_tiles(gw_render_octree *o, uint32_t level, uint64_t **keys, size_t *count,
							   gw_error *error)
{
	gw_octree *t = &o->octree;
	bool leaves = level == t->depth;
	uint32_t first = leaves ? 0 : t->tile_first[level];
	*count = leaves ? t->leaf_tile_count : t->tile_first[level + 1] - first;
	/* A key is two words, the low one first, as a little-endian uint64_t is. */
	*keys = gw_allocate_array(*count, sizeof **keys);
	if (!*keys)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu tiles", *count);
	GW_TRY(gw_buffer_download(o->gpu, leaves ? &t->leaf_tile_key : &t->tile_key,
							  8 * (uint64_t)first, *keys, 8 * (uint64_t)*count, error));
	*count = sort_unique(*keys, *count);
	return GW_OK;
}

gw_status gw_cells_list_borders(gw_render_octree *o, uint32_t level, gw_cells *cells,
								gw_error *error)
{
	gw_cells full = { .count = 0 };
	*cells = (gw_cells){ .count = 0 };
	GW_TRY(check_level(&o->octree, level, error));
	set_size(&o->octree, level - 1, cells);
	gw_status status = keys_of_leaves(o, level - 1, &full.key, &full.count, error);
	if (status == GW_OK)
		status = keys_of_tiles(o, level, &cells->key, &cells->count, error);
	size_t kept = 0;
	for (size_t i = 0; i < cells->count && status == GW_OK; i++)
		if (gw_cells_find(&full, cells->key[i]) == SIZE_MAX)
			cells->key[kept++] = cells->key[i];
	cells->count = kept;
	gw_cells_clear(&full);
	if (status != GW_OK)
		gw_cells_clear(cells);
	return status;
}

void gw_cells_clear(gw_cells *cells)
{
	free(cells->key);
	*cells = (gw_cells){ .count = 0 };
}

size_t gw_cells_find(const gw_cells *cells, uint64_t key)
{
	size_t first = gw_lower_bound(cells->key, cells->count, key);
	return first < cells->count && cells->key[first] == key ? first : SIZE_MAX;
}

static void fill_centres(const gw_cells *cells, float width, float *centre)
{
	for (size_t i = 0; i < cells->count; i++) {
		uint32_t cell[3];
		gw_morton_decode(cells->key[i], cell);
		for (size_t k = 0; k < 3; k++)
			centre[4 * i + k] = ((float)cell[k] + 0.5f) * width;
	}
}

/* Vec4 a cell. */
typedef struct show_buffers {
	gw_buffer centre, result;
} show_buffers;

static gw_status run_show(gw_render_octree *o, const gw_cells *cells, const gw_cone_push *push,
						  show_buffers *buffers, float *shown, gw_error *error)
{
	uint64_t bytes = 16 * (uint64_t)cells->count;
	GW_TRY(gw_buffer_create(
		o->gpu,
		&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes, "cell centre" },
		&buffers->centre, error));
	GW_TRY(gw_buffer_create(
		o->gpu,
		&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes, "cell shown" },
		&buffers->result, error));
	GW_TRY(gw_buffer_upload(o->gpu, &buffers->centre, 0, shown, bytes, error));
	const gw_binding bindings[] = {
		gw_whole(&o->octree.level_directory), gw_whole(&o->octree.node),
		gw_voxels_of(&o->bricks.leaf_pool),   gw_voxels_of(&o->bricks.mip_pool),
		gw_window(&buffers->centre, 16),      gw_window(&buffers->result, 16)
	};
	GW_TRY(gw_passes_run(&o->passes, GW_PASS_CELL_BRICKS, bindings, push, cells->count, error));
	return gw_buffer_download(o->gpu, &buffers->result, 0, shown, bytes, error);
}

gw_status gw_cells_show(gw_render_octree *o, const gw_cells *cells, uint32_t level, uint32_t side,
						float *shown, gw_error *error)
{
	const float black[3] = { 0 }, sign = side % 2 ? -1.0f : 1.0f;
	gw_cone_push push = gw_cone_gather_push(&o->bricks, o->scale, black);
	push.level = o->octree.depth - level;
	push.eye = (vec4){ side / 2 == 0 ? sign : 0.0f, side / 2 == 1 ? sign : 0.0f,
					   side / 2 == 2 ? sign : 0.0f, 0.0f };
	fill_centres(cells, (float)(1u << push.level), shown);
	show_buffers buffers = { 0 };
	gw_status status = cells->count ? run_show(o, cells, &push, &buffers, shown, error) : GW_OK;
	gw_buffer_destroy(o->gpu, &buffers.centre);
	gw_buffer_destroy(o->gpu, &buffers.result);
	return status;
}
