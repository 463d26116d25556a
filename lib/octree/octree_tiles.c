/*
 * octree_tiles.c - leaves from sorted fragments, tiles from leaves, and the pointers between them;
 * see octree_steps.h.
 */
#include "octree/octree_steps.h"

/* -------------------------------------------------------------------------------- distinct keys */

/* What octree_keys.glsl reads. */
static gw_keys_push push_of(const gw_key_list *list)
{
	return (
		gw_keys_push){ .shift = list->shift, .split = list->high != NULL, .total = list->count };
}

static gw_status count_distinct(gw_octree_work *work, const gw_key_list *list, uint64_t *distinct,
								gw_error *error)
{
	const gw_keys_push push = push_of(list);
	uint32_t count = list->count;
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, 4 * (uint64_t)count, "marks",
								  &work->marks, error));
	gw_binding bindings[] = { GW_WHOLE(list->keys),
							  GW_WHOLE(list->high != NULL ? list->high : list->keys),
							  GW_WINDOW(&work->marks, 4) };
	GW_TRY(gw_passes_run(&work->passes, GW_PASS_OCTREE_MARK, bindings, &push, count, error));
	return gw_prefix_sum_run(&work->passes, &work->sort.prefix, &work->marks, count, distinct,
							 error);
}

static gw_status write_distinct(gw_octree_work *work, const gw_key_list *list, gw_buffer *result,
								gw_error *error)
{
	const gw_keys_push push = push_of(list);
	gw_binding bindings[] = { GW_WHOLE(list->keys),
							  GW_WHOLE(list->high != NULL ? list->high : list->keys),
							  GW_WINDOW(&work->marks, 4), GW_WHOLE(result),
							  GW_WHOLE(&work->first) };
	return gw_passes_run(&work->passes, GW_PASS_OCTREE_UNIQUE, bindings, &push, list->count, error);
}

/*
 * Distinct keys of a sorted list.
 *   name    of the result
 *   result  receives a new buffer, R32G32_UINT; work->first is made anew
 */
static gw_status find_distinct(gw_octree_work *work, const gw_key_list *list, const char *name,
							   gw_buffer *result, uint32_t *result_count, gw_error *error)
{
	gw_buffer_destroy(work->gpu, &work->marks);
	gw_buffer_destroy(work->gpu, &work->first);
	uint64_t distinct;
	GW_TRY(count_distinct(work, list, &distinct, error));
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32G32_UINT, 8 * distinct, name, result, error));
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, 4 * (distinct + 1),
								  "first of equal keys", &work->first, error));
	GW_TRY(gw_buffer_upload(work->gpu, &work->first, 4 * distinct, &list->count, 4, error));
	GW_TRY(write_distinct(work, list, result, error));
	*result_count = (uint32_t)distinct;
	gw_buffer_destroy(work->gpu, &work->marks);
	return GW_OK;
}

/* ---------------------------------------------------------------------------------------- tiles */

static gw_status run_border(gw_octree_work *work, uint32_t t, gw_border_push push, gw_error *error)
{
	gw_buffer *high = work->list.wide ? &work->list.high : &work->list.low;
	/* Counting writes no list. */
	gw_binding bindings[] = {
		GW_WHOLE(&work->real[t]),
		GW_WHOLE(&work->real[t + 1]),
		GW_WHOLE(&work->first),
		GW_WINDOW(&work->marks, 4),
		GW_WHOLE(push.emit ? &work->list.low : &work->marks),
		GW_WHOLE(push.emit ? high : &work->marks),
	};
	return gw_passes_run(&work->passes, GW_PASS_OCTREE_BORDER, bindings, &push, work->real_count[t],
						 error);
}

/*
 * The cells of level t whose children are a tile: the parents of all below (for leaf tiles, of the
 * leaves), and those of the border tiles that cells of level t + 1 need. work->first says where
 * the cells of each real tile begin.
 */
static gw_status add_parents(gw_octree_work *work, uint32_t t, gw_error *error)
{
	gw_octree *octree = work->octree;
	bool leaf_tiles = t + 1 == octree->depth, wide = 3 * t > 32;
	gw_buffer *below = leaf_tiles ? &work->real[t] : &work->parent[t + 1];
	uint32_t below_count = leaf_tiles ? work->real_count[t] : work->parent_count[t + 1];
	gw_border_push push = { .cells = work->real_count[t + 1],
							.tiles = work->real_count[t],
							.wide = wide,
							.base = below_count };
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, 4 * (uint64_t)push.tiles,
								  "border tiles of tiles", &work->marks, error));
	GW_TRY(run_border(work, t, push, error));
	uint64_t borders;
	GW_TRY(gw_prefix_sum_run(&work->passes, &work->sort.prefix, &work->marks, push.tiles, &borders,
							 error));
	GW_TRY(gw_sort_list_create(work->gpu, below_count + borders, wide, &work->list, error));
	push.emit = 1;
	GW_TRY(run_border(work, t, push, error));
	gw_buffer *high = wide ? &work->list.high : &work->list.low;
	gw_keys_push copy = { .shift = leaf_tiles ? 0 : 3, .total = wide };
	gw_binding copying[] = { GW_WHOLE(below), GW_WHOLE(below), GW_WINDOW(&work->list.low, 4),
							 GW_WINDOW(high, 4) };
	GW_TRY(
		gw_passes_run(&work->passes, GW_PASS_OCTREE_PARENTS, copying, &copy, below_count, error));
	if (t > 0)
		GW_TRY(gw_radix_sort_run(&work->passes, &work->sort, &work->list, 3 * t, error));
	gw_sort_list_trim(work->gpu, &work->list);
	const gw_key_list list = { &work->list.low, wide ? high : NULL, (uint32_t)work->list.count, 0 };
	GW_TRY(find_distinct(work, &list, "tile keys of a level", &work->parent[t],
						 &work->parent_count[t], error));
	gw_sort_list_destroy(work->gpu, &work->list);
	return GW_OK;
}

/* One level of tiles. Rays need no border tiles: then the parents are those of what there is. */
static gw_status make_level(gw_octree_work *work, uint32_t t, gw_error *error)
{
	bool leaf_tiles = t + 1 == work->octree->depth, bordered = work->regions;
	gw_buffer *below = leaf_tiles || bordered ? &work->real[t + 1] : &work->parent[t + 1];
	const gw_key_list cells = { below, NULL, work->real_count[t + 1], 3 };
	GW_TRY(find_distinct(work, &cells, bordered ? "cells of a level" : "tile keys of a level",
						 bordered ? &work->real[t] : &work->parent[t], &work->real_count[t],
						 error));
	work->parent_count[t] = work->real_count[t];
	if (bordered)
		GW_TRY(add_parents(work, t, error));
	/* Leaf keys are needed further. */
	if (!leaf_tiles)
		gw_buffer_destroy(work->gpu, &work->real[t + 1]);
	return GW_OK;
}

static gw_status make_levels(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	for (uint32_t t = octree->depth; t-- > 0;) {
		GW_TRY(make_level(work, t, error));
		octree->border_tile_count += work->parent_count[t] - work->real_count[t];
	}
	gw_buffer_destroy(work->gpu, &work->real[0]);
	gw_buffer_destroy(work->gpu, &work->first);
	uint64_t tiles = 0;
	for (uint32_t l = 1; l < octree->depth; l++) {
		octree->tile_first[l] = (uint32_t)tiles;
		tiles += work->parent_count[l - 1];
	}
	octree->tile_first[octree->depth] = octree->tile_count = (uint32_t)tiles;
	octree->leaf_tile_count = work->parent_count[octree->depth - 1];
	if (tiles > UINT32_MAX / 8)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%llu tiles are more than can be addressed: use a "
					   "smaller depth than %u",
					   (unsigned long long)tiles, octree->depth);
	return GW_OK;
}

static gw_status create_tree(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint64_t tiles = octree->tile_count, leaf_tiles = octree->leaf_tile_count;
	uint64_t entries = ((UINT64_C(8) << 3 * octree->directory_level) - 1) / 7;
	const gw_octree_part part[] = {
		{ &octree->node, VK_FORMAT_R32_UINT, 32 * tiles, "nodes" },
		{ &octree->tile_key, VK_FORMAT_R32G32_UINT, 8 * tiles, "tile keys" },
		{ &octree->tile_neighbour, VK_FORMAT_R32_UINT, 32 * tiles, "tile neighbours" },
		{ &octree->leaf_tile_key, VK_FORMAT_R32G32_UINT, 8 * leaf_tiles, "leaf tile keys" },
		{ &octree->leaf_tile_neighbour, VK_FORMAT_R32_UINT, 32 * leaf_tiles,
		  "leaf tile neighbours" },
		{ &octree->leaf_tile, VK_FORMAT_R32G32_UINT, 8 * leaf_tiles, "leaf tiles" },
		{ &octree->leaf_cell, VK_FORMAT_R32G32B32A32_UINT, 16 * (uint64_t)octree->leaf_count,
		  "leaf cells" },
		{ &octree->level_directory, VK_FORMAT_R32_UINT, 4 * entries, "directory of levels" },
	};
	return gw_octree_buffers(work, part, sizeof part / sizeof *part, error);
}

/* Pointers of the tiles whose parent cells are of level t. */
static gw_status link_level(gw_octree_work *work, uint32_t t, gw_error *error)
{
	gw_octree *octree = work->octree;
	bool leaf_tiles = t + 1 == octree->depth;
	gw_tiles_push push = {
		.level = t,
		.tile_first = leaf_tiles ? 0 : octree->tile_first[t + 1],
		.parent_first = t > 0 ? octree->tile_first[t] : 0,
		.parent_count = t > 0 ? work->parent_count[t - 1] : 0,
		.directory = t <= octree->directory_level,
		.total = work->parent_count[t],
	};
	gw_binding bindings[] = {
		GW_WHOLE(&work->parent[t]),
		GW_WHOLE(&work->parent[t > 0 ? t - 1 : t]),
		GW_WHOLE(leaf_tiles ? &octree->leaf_tile_key : &octree->tile_key),
		GW_WHOLE(leaf_tiles ? &octree->leaf_tile_neighbour : &octree->tile_neighbour),
		GW_WHOLE(&octree->node),
		GW_WHOLE(&octree->level_directory),
	};
	return gw_passes_run(&work->passes, GW_PASS_OCTREE_LINK, bindings, &push, push.total, error);
}

gw_status gw_octree_find_leaves(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint32_t depth = octree->depth;
	const gw_key_list keys = { &work->keys.low, work->keys.wide ? &work->keys.high : NULL,
							   octree->fragment_count, 0 };
	GW_TRY(find_distinct(work, &keys, "leaf keys", &work->real[depth], &work->real_count[depth],
						 error));
	octree->leaf_count = work->real_count[depth];
	gw_sort_list_destroy(work->gpu, &work->keys);
	octree->leaf_fragment = work->first;
	octree->leaf_fragment.name = "first fragments of leaves";
	work->first = (gw_buffer){ 0 };
	return GW_OK;
}

gw_status gw_octree_make_tiles(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint32_t depth = octree->depth;
	GW_TRY(make_levels(work, error));
	GW_TRY(create_tree(work, error));
	for (uint32_t t = 0; t < depth; t++)
		GW_TRY(link_level(work, t, error));
	gw_leaves_push push = { .leaves = octree->leaf_count };
	gw_binding bindings[] = { GW_WHOLE(&work->parent[depth - 1]), GW_WHOLE(&work->real[depth]),
							  GW_WINDOW(&octree->leaf_tile, 8), GW_WHOLE(&octree->leaf_cell) };
	GW_TRY(gw_passes_run(&work->passes, GW_PASS_OCTREE_LEAF_TILES, bindings, &push,
						 octree->leaf_tile_count, error));
	for (uint32_t t = 0; t <= depth; t++) {
		gw_buffer_destroy(work->gpu, &work->real[t]);
		gw_buffer_destroy(work->gpu, &work->parent[t]);
	}
	return GW_OK;
}
