/*
 * compartment_necks.c - which empty cells are part of ways so narrow that they may be holes that
 * points missed; see compartments_join.c.
 *
 * Leaves with walls on both sides are, along any axis, unless surface ends on either side, as at a
 * window, or a closed void lies there, which tells nothing. So is what discs of sparse surface
 * would cover were they not cut: as few points as there are do not tell where it ends.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"
#include "octree/octree_layout.h"

#include <stdlib.h>

/* Leaves of a tile at its lower side along an axis. */
static const uint8_t lower[3] = { 0x55, 0x33, 0x0f };

typedef struct narrows {
	gw_compartments *c;
	/* A leaf tile: which of its leaves hold discs that are cut where surface ends, or no disc. */
	uint8_t *rims;
} narrows;

/* What an octree knows of its discs. */
typedef struct views {
	gw_leaf_views leaves;
	gw_view normal, size, clip;
} views;

/* Leaves of a tile. */
typedef struct leaves {
	uint32_t walls, rims;
} leaves;

/* Those of the tile at a place, in tiles. */
static leaves leaves_at(const narrows *n, const int32_t at[3])
{
	const int32_t leaf[3] = { 2 * at[0], 2 * at[1], 2 * at[2] };
	for (int k = 0; k < 3; k++)
		if (at[k] < 0 || at[k] >= 1 << (n->c->depth - 1))
			return (leaves){ 0, 0 };
	uint32_t tile = gw_compartment_leaf_tile(n->c, leaf);
	if (tile != 0)
		return (leaves){ n->c->leaves[tile - 1], n->rims[tile - 1] };
	return (leaves){ gw_compartment_lies_in_wall(n->c, leaf) ? 0xffu : 0u, 0xffu };
}

/* Which empty leaves of a tile lie between two walls along an axis, not both of which are rims. */
static uint32_t between(const narrows *n, uint32_t tile, const int32_t at[3], uint32_t axis)
{
	uint32_t low = lower[axis], high = 0xffu & ~low, shift = 1u << axis, found = 0;
	const leaves own = { n->c->leaves[tile], n->rims[tile] };
	uint32_t under = (own.walls & high) >> shift & ~own.walls;
	uint32_t over = (own.walls & low) << shift & ~own.walls;
	int32_t to[3] = { at[0], at[1], at[2] };
	if (under != 0) {
		to[axis] = at[axis] - 1;
		const leaves down = leaves_at(n, to);
		found |= under & (down.walls & high) >> shift & ~((own.rims & down.rims & high) >> shift);
	}
	if (over != 0) {
		to[axis] = at[axis] + 1;
		const leaves up = leaves_at(n, to);
		found |= over & (up.walls & low) << shift & ~((own.rims & up.rims & low) << shift);
	}
	return found;
}

/* All tiles of leaves in a cell, whose place is given in cells of its level. */
static void look_between(narrows *n, gw_compartment_cell of, const int32_t at[3])
{
	if (of.tile == 0 || of.tile == GW_WALL)
		return;
	if (of.level + 1 == n->c->depth) {
		for (uint32_t axis = 0; axis < 3; axis++)
			n->c->leaf_neck[of.tile - 1] |= (uint8_t)between(n, of.tile - 1, at, axis);
		return;
	}
	for (uint32_t octant = 0; octant < 8; octant++) {
		const int32_t to[3] = { 2 * at[0] + (int32_t)(octant & 1u),
								2 * at[1] + (int32_t)(octant >> 1 & 1u),
								2 * at[2] + (int32_t)(octant >> 2) };
		look_between(n, gw_compartment_child(n->c, of, octant), to);
	}
}

/* Is a disc cut, and not at creases alone? */
static bool ends(const views *v, size_t surfel)
{
	const float *clip = (const float *)v->clip.bytes + 4 * surfel;
	const float *normal = (const float *)v->normal.bytes + 4 * surfel;
	const float *size = (const float *)v->size.bytes + 4 * surfel;
	bool cut = size[2] != 0.0f || size[3] != 0.0f || clip[1] != 0.0f || clip[2] != 0.0f;
	return cut && normal[3] != GW_MARK_CREASED;
}

static void find_rims(const narrows *n, uint32_t leaf_tiles, const views *v)
{
	const uint32_t *tile = v->leaves.tile.bytes, *first = v->leaves.first.bytes;
	const uint32_t *fragment = v->leaves.fragment.bytes;
	for (uint32_t t = 0; t < leaf_tiles; t++) {
		size_t leaf = gw_leaf_views_first(&v->leaves, t);
		for (uint32_t octant = 0; octant < 8; octant++) {
			bool rim = (tile[2 * t + 1] >> octant & 1u) == 0;
			for (uint32_t f = rim ? 0 : first[leaf]; !rim && f < first[leaf + 1]; f++)
				rim = ends(v, fragment[f] & GW_FRAGMENT_SURFEL);
			n->rims[t] |= (uint8_t)(rim << octant);
			leaf += tile[2 * t + 1] >> octant & 1u;
		}
	}
}

static gw_status open_views(gw_gpu *gpu, const gw_octree *o, views *v, gw_error *error)
{
	GW_TRY(gw_view_open(gpu, &o->surfel_normal, o->surfel_normal.bytes, &v->normal, error));
	GW_TRY(gw_view_open(gpu, &o->surfel_disc, o->surfel_disc.bytes, &v->size, error));
	GW_TRY(gw_view_open(gpu, &o->surfel_clip, o->surfel_clip.bytes, &v->clip, error));
	return gw_leaf_views_open(gpu, o, &v->leaves, error);
}

static gw_status find_between(gw_gpu *gpu, const gw_octree *octree, narrows *n, gw_error *error)
{
	const gw_compartment_cell root = { GW_COMPARTMENT_UNKNOWN, 1, 0 };
	const int32_t corner[3] = { 0, 0, 0 };
	views v = { 0 };
	gw_status status = open_views(gpu, octree, &v, error);
	if (status == GW_OK) {
		find_rims(n, octree->leaf_tile_count, &v);
		look_between(n, root, corner);
	}
	gw_view_close(&v.normal);
	gw_view_close(&v.size);
	gw_view_close(&v.clip);
	gw_leaf_views_close(&v.leaves);
	return status;
}

gw_status gw_compartments_find_necks(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, uint32_t threads,
									 gw_compartments *c, gw_error *error)
{
	narrows n = { c, gw_allocate_zeros(octree->leaf_tile_count, 1) };
	c->node_neck = gw_allocate_zeros(c->first / 8, 1);
	c->leaf_neck = gw_allocate_zeros(octree->leaf_tile_count, 1);
	gw_status status =
		n.rims && c->node_neck && c->leaf_neck
			? find_between(gpu, octree, &n, error)
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for the necks of %u tiles", c->first / 8);
	free(n.rims);
	return status == GW_OK ? gw_compartments_mark_discs(gpu, octree, surfels, threads, c, error)
						   : status;
}
