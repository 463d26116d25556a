/*
 * octree_numbers.c - the numbers of facets; see octree_steps.h.
 */
#include "octree/octree_steps.h"

/* ------------------------------------------------------------------------------------ numbering */

/* Does a leaf have a second facet? */
static bool has_second(const uint32_t *seed, size_t leaf)
{
	return seed[4 * leaf + 2] != 0;
}

/* Fills facet_leaf. */
static void list_facets(const uint32_t *seed, uint32_t leaves, uint32_t *facet_leaf)
{
	uint32_t facet = GW_FACET_EMPTY + 1, without = 0;
	for (uint32_t leaf = 0; leaf < leaves; leaf++) {
		facet_leaf[facet++] = leaf;
		if (has_second(seed, leaf))
			facet_leaf[facet++] = leaf | GW_FACET_SECOND;
	}
	while (without < leaves && has_second(seed, without))
		without++;
	facet_leaf[GW_FACET_EMPTY] = (without < leaves ? without : 0) | GW_FACET_SECOND;
}

/* Of tiles, whose leaves come in the same order, first facets in place of first leaves. */
static void enter_facets(const uint32_t *facet_leaf, uint32_t tiles, uint32_t *leaf_tile)
{
	uint32_t facet = GW_FACET_EMPTY + 1;
	for (size_t i = 0; i < tiles; i++) {
		if (leaf_tile[2 * i + 1] == 0)
			continue;
		while (facet_leaf[facet] != leaf_tile[2 * i])
			facet++;
		leaf_tile[2 * i] = facet;
	}
}

static gw_status write_numbers(gw_octree_work *work, const uint32_t *seed, gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_edit numbers = { 0 }, tiles = { 0 };
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, 4 * (uint64_t)octree->facet_count,
								  "leaves of facets", &octree->facet_leaf, error));
	GW_TRY(gw_edit_open(work->gpu, &octree->facet_leaf, &numbers, error));
	gw_status status = gw_edit_open(work->gpu, &octree->leaf_tile, &tiles, error);
	bool opened = status == GW_OK;
	if (opened) {
		list_facets(seed, octree->leaf_count, numbers.bytes);
		enter_facets(numbers.bytes, octree->leaf_tile_count, tiles.bytes);
	}
	gw_edit *const edit[] = { &numbers, &tiles };
	for (int i = 0; i < 2; i++) {
		gw_status closed = gw_edit_close(work->gpu, edit[i], opened, error);
		status = status == GW_OK ? closed : status;
	}
	return status;
}

gw_status gw_octree_number_facets(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint64_t bytes = 16 * (uint64_t)octree->leaf_count;
	gw_view seed;
	GW_TRY(gw_view_open(work->gpu, &work->seed, bytes, &seed, error));
	octree->facet_count = octree->leaf_count + 1;
	for (size_t leaf = 0; leaf < octree->leaf_count; leaf++)
		octree->facet_count += has_second(seed.bytes, leaf);
	octree->dark_facet = work->surfels->transparency != NULL ? GW_FACET_EMPTY + 1 : 0;
	gw_status status = write_numbers(work, seed.bytes, error);
	gw_view_close(&seed);
	return status;
}

/* ------------------------------------------------------------------------------------- checking */

/* Are there as many leaves, each with one facet or two that follow each other? */
static bool leaves_fit(const gw_octree *octree, const uint32_t *facet_leaf)
{
	uint32_t empty = facet_leaf[GW_FACET_EMPTY], leaves = 0;
	bool alone = false;
	for (uint32_t i = GW_FACET_EMPTY + 1; i < octree->facet_count; i++) {
		bool second = gw_facet_is_second(facet_leaf[i]);
		if (second && !alone)
			return false;
		leaves += !second;
		alone = !second;
		if (gw_facet_leaf(facet_leaf[i]) + 1 != leaves)
			return false;
	}
	return leaves == octree->leaf_count && gw_facet_is_second(empty) &&
		   gw_facet_leaf(empty) < leaves;
}

/* Does a tile count its facets as they are? */
static bool tile_fits(const uint32_t *facet_leaf, uint32_t facets, const uint32_t tile[2])
{
	uint32_t has = tile[1] >> 8 | tile[1] >> 16 | tile[1] >> 24;
	if ((has & ~tile[1] & 0xffu) != 0)
		return false;
	for (uint32_t octant = 0; octant < 8; octant++) {
		uint32_t facet = gw_facet_first(tile, octant);
		if ((tile[1] >> octant & 1u) == 0)
			continue;
		if (facet >= facets || gw_facet_is_second(facet_leaf[facet]))
			return false;
		if ((tile[1] >> (16 + octant) & 1u) != 0 &&
			(facet + 1 >= facets || !gw_facet_is_second(facet_leaf[facet + 1])))
			return false;
	}
	return true;
}

bool gw_octree_numbers_fit(const gw_octree *octree, const uint32_t *facet_leaf,
						   const uint32_t *leaf_tile)
{
	bool fit = leaves_fit(octree, facet_leaf);
	for (size_t i = 0; i < octree->leaf_tile_count && fit; i++)
		fit = tile_fits(facet_leaf, octree->facet_count, leaf_tile + 2 * i);
	return fit;
}
