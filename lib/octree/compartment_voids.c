/*
 * compartment_voids.c - closes the voids that random points leave in surface; see compartments.h.
 *
 * A void is a cell or two across: an empty cell that has surface near it on both sides along two of
 * the three axes. So has one in a tunnel as narrow as that, which the octree cannot tell from rock.
 *
 * Where walls of dense surface and of sparse one meet, and where a thin column stands before a
 * wall, cells have a void on one side that is closed by now. So once all walls are made leaves are
 * looked through once more. A hole that is wider than two cells everywhere stays open in every
 * round.
 */
#include "octree/compartments_steps.h"

#include "glowworm_picture.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Tiles of one level: which of their eight cells hold something, and those beside them. */
typedef struct tiles {
	uint32_t count;
	uint8_t *holds, *closes; /* one a tile */
	uint8_t *walled;         /* one a tile: a bit for each pointer beside that is 0 as there is
							  * nothing but wall */
	uint32_t *beside;        /* 6 a tile: pointers (plus one) below and above, axis by axis */
	uint32_t widest;         /* cells: of voids along an axis */
} tiles;

static bool allocate(tiles *t)
{
	t->holds = gw_allocate_zeros(t->count, 1);
	t->closes = gw_allocate_zeros(t->count, 1);
	t->walled = gw_allocate_zeros(t->count, 1);
	t->beside = gw_allocate_zeros(t->count, 6 * sizeof *t->beside);
	return t->holds && t->closes && t->walled && t->beside;
}

static void clear(tiles *t)
{
	free(t->holds);
	free(t->closes);
	free(t->walled);
	free(t->beside);
}

/* The octree knows the tiles above. first: the number of tile 0. */
static void find_beside(tiles *t, const uint32_t *neighbour, uint32_t first)
{
	for (uint32_t i = 0; i < t->count; i++) {
		for (uint32_t axis = 0; axis < 3; axis++) {
			uint32_t to = neighbour[8 * (size_t)i + (1u << axis)];
			if (to == 0)
				continue;
			t->beside[6 * (size_t)i + 2 * axis + 1] = to - first;
			t->beside[6 * (size_t)(to - first - 1) + 2 * axis] = i + 1;
		}
	}
}

/* Does a cell of the tile beside one hold something? */
static uint32_t holds_beside(const tiles *t, uint32_t tile, uint32_t side, uint32_t octant)
{
	uint32_t pointer = t->beside[6 * (size_t)tile + side];
	if (pointer == 0)
		return (uint32_t)t->walled[tile] >> side & 1u;
	return (uint32_t)t->holds[pointer - 1] >> octant & 1u;
}

/* Does a cell have surface near it on both sides along an axis? */
static bool lies_between(const tiles *t, uint32_t tile, uint32_t octant, uint32_t axis)
{
	uint32_t bit = 1u << axis, low = octant & ~bit, high = octant | bit, own = t->holds[tile];
	uint32_t below_it = 2 * axis, above_it = below_it + 1;
	uint32_t line = holds_beside(t, tile, below_it, low) |
					holds_beside(t, tile, below_it, high) << 1 | (own >> low & 1u) << 2 |
					(own >> high & 1u) << 3 | holds_beside(t, tile, above_it, low) << 4 |
					holds_beside(t, tile, above_it, high) << 5;
	uint32_t at = octant & bit ? 3 : 2;
	bool below = line >> (at - 1) & 1u, above = line >> (at + 1) & 1u;
	if (below && above)
		return true;
	return t->widest > 1 &&
		   ((below && (line >> (at + 2) & 1u)) || (above && (line >> (at - 2) & 1u)));
}

static void find_voids(tiles *t)
{
	for (uint32_t i = 0; i < t->count; i++)
		for (uint32_t octant = 0; octant < 8; octant++) {
			uint32_t axes = 0;
			for (uint32_t axis = 0; axis < 3 && ((uint32_t)t->holds[i] >> octant & 1u) == 0; axis++)
				axes += lies_between(t, i, octant, axis);
			t->closes[i] |= (uint8_t)((axes > 1) << octant);
		}
}

/* Which of the tiles of leaves that there are not lie in walls of wider cells. */
static void find_walled(tiles *t, const uint32_t *key, const gw_compartments *c)
{
	for (uint32_t i = 0; i < t->count; i++) {
		uint32_t of[3];
		gw_morton_decode(key[2 * (size_t)i] | (uint64_t)key[2 * (size_t)i + 1] << 32, of);
		for (uint32_t side = 0; side < 6; side++) {
			int32_t at[3] = { 2 * (int32_t)of[0], 2 * (int32_t)of[1], 2 * (int32_t)of[2] };
			at[side / 2] += side % 2 ? 2 : -2;
			if (t->beside[6 * (size_t)i + side] == 0 && gw_compartment_lies_in_wall(c, at))
				t->walled[i] |= (uint8_t)(1u << side);
		}
	}
}

/* key: of tiles, where walls of wider cells count. */
static gw_status close_leaves(const gw_octree *octree, const uint32_t *neighbour,
							  const uint32_t *key, gw_compartments *c, gw_error *error)
{
	tiles t = { .count = octree->leaf_tile_count, .widest = 2 };
	bool fits = allocate(&t);
	if (fits) {
		memcpy(t.holds, c->leaves, t.count);
		find_beside(&t, neighbour, 0);
		if (key != NULL)
			find_walled(&t, key, c);
		find_voids(&t);
		for (uint32_t i = 0; i < t.count; i++)
			c->leaves[i] |= t.closes[i];
	}
	clear(&t);
	return fits ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u tiles", t.count);
}

/* Of the level above: a void may take up all of a node. */
static gw_status close_nodes(const gw_octree *octree, const uint32_t *neighbour, gw_compartments *c,
							 gw_error *error)
{
	uint32_t level = octree->depth - 1, first = octree->tile_first[level];
	tiles t = { .count = octree->tile_first[level + 1] - first, .widest = 1 };
	bool fits = allocate(&t);
	for (uint32_t i = 0; i < t.count && fits; i++)
		for (uint32_t octant = 0; octant < 8; octant++)
			t.holds[i] |= (uint8_t)((c->child[8 * (first + i) + octant] != 0) << octant);
	if (fits) {
		find_beside(&t, neighbour + 8 * (size_t)first, first);
		find_voids(&t);
		for (uint32_t i = 0; i < 8 * t.count; i++)
			if ((uint32_t)t.closes[i / 8] >> i % 8 & 1u)
				c->child[8 * first + i] = GW_WALL;
	}
	clear(&t);
	return fits ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u tiles", t.count);
}

gw_status gw_compartments_close_voids(gw_gpu *gpu, const gw_octree *octree, gw_compartments *c,
									  gw_error *error)
{
	gw_view leaves = { 0 }, nodes = { 0 };
	gw_status status = gw_view_open(gpu, &octree->leaf_tile_neighbour,
									32 * (uint64_t)octree->leaf_tile_count, &leaves, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->tile_neighbour, 32 * (uint64_t)octree->tile_count,
							  &nodes, error);
	if (status == GW_OK)
		status = close_nodes(octree, nodes.bytes, c, error);
	if (status == GW_OK)
		status = close_leaves(octree, leaves.bytes, NULL, c, error);
	gw_view_close(&nodes);
	gw_view_close(&leaves);
	return status;
}

gw_status gw_compartments_close_voids_again(gw_gpu *gpu, const gw_octree *octree,
											gw_compartments *c, gw_error *error)
{
	gw_view neighbour = { 0 }, key = { 0 };
	uint64_t count = octree->leaf_tile_count;
	gw_status status =
		gw_view_open(gpu, &octree->leaf_tile_neighbour, 32 * count, &neighbour, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->leaf_tile_key, 8 * count, &key, error);
	if (status == GW_OK)
		status = close_leaves(octree, neighbour.bytes, key.bytes, c, error);
	gw_view_close(&key);
	gw_view_close(&neighbour);
	return status;
}
