/*
 * compartment_voids.c - closes the voids that random points leave in surface; see compartments.h.
 *
 * A void is a cell or two across: an empty cell that has surface near it on both sides along two of
 * the three axes. So has one in a tunnel as narrow as that, which the octree cannot tell from rock.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Tiles of one level: which of their eight cells hold something, and those beside them. */
typedef struct tiles {
	uint32_t count;
	uint8_t *holds, *closes; /* one a tile */
	uint32_t *beside;        /* 6 a tile: pointers (plus one) below and above, axis by axis */
	uint32_t widest;         /* cells: of voids along an axis */
} tiles;

static bool allocate(tiles *t)
{
	t->holds = gw_allocate_zeros(t->count, 1);
	t->closes = gw_allocate_zeros(t->count, 1);
	t->beside = gw_allocate_zeros(t->count, 6 * sizeof *t->beside);
	return t->holds && t->closes && t->beside;
}

static void clear(tiles *t)
{
	free(t->holds);
	free(t->closes);
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

static uint32_t holds_at(const tiles *t, uint32_t pointer, uint32_t octant)
{
	return pointer == 0 ? 0 : (uint32_t)t->holds[pointer - 1] >> octant & 1u;
}

/* Does a cell have surface near it on both sides along an axis? */
static bool lies_between(const tiles *t, uint32_t tile, uint32_t octant, uint32_t axis)
{
	const uint32_t *beside = t->beside + 6 * (size_t)tile + 2 * axis;
	uint32_t bit = 1u << axis, low = octant & ~bit, high = octant | bit;
	uint32_t line = holds_at(t, beside[0], low) | holds_at(t, beside[0], high) << 1 |
					holds_at(t, tile + 1, low) << 2 | holds_at(t, tile + 1, high) << 3 |
					holds_at(t, beside[1], low) << 4 | holds_at(t, beside[1], high) << 5;
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

static gw_status close_leaves(const gw_octree *octree, const uint32_t *neighbour,
							  gw_compartments *c, gw_error *error)
{
	tiles t = { .count = octree->leaf_tile_count, .widest = 2 };
	bool fits = allocate(&t);
	if (fits) {
		memcpy(t.holds, c->leaves, t.count);
		find_beside(&t, neighbour, 0);
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
		status = close_leaves(octree, leaves.bytes, c, error);
	gw_view_close(&nodes);
	gw_view_close(&leaves);
	return status;
}
