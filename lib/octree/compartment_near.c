/*
 * compartment_near.c - leaves that surface comes near but does not pass are no walls; see
 * compartments.h.
 *
 * Leaves are made wherever a region of influence reaches, up to a cell off the surface: in a gap of
 * three spacings between two sheets there would be nothing but walls, and light that gets out of it
 * would count as light that slipped through rock. Before a surface is space. In the surface itself
 * these leaves close what random points leave open, and behind it they make a thin sheet thicker.
 */
#include "octree/compartments_steps.h"

#include "octree/octree_layout.h"

typedef struct near_leaves {
	gw_leaf_views leaves;
	gw_view cell, place, normal;
} near_leaves;

/* Does a leaf lie before the planes of all surfels that count in it? */
static bool is_before(const near_leaves *n, size_t leaf)
{
	const int32_t *cell = (const int32_t *)n->cell.bytes + 4 * leaf;
	const uint32_t *first = n->leaves.first.bytes, *fragment = n->leaves.fragment.bytes;
	for (uint32_t f = first[leaf]; f < first[leaf + 1]; f++) {
		size_t surfel = 4 * (size_t)(fragment[f] & GW_FRAGMENT_SURFEL);
		float reach,
			off = gw_cell_before_plane((const float *)n->place.bytes + surfel,
									   (const float *)n->normal.bytes + surfel, cell, 1, &reach);
		if (off <= reach)
			return false;
	}
	return true;
}

static void open_near_leaves(const near_leaves *n, uint32_t leaf_tiles, gw_compartments *c)
{
	const uint32_t *tile = n->leaves.tile.bytes;
	for (uint32_t t = 0; t < leaf_tiles; t++) {
		uint32_t bits = tile[2 * t + 1];
		size_t leaf = gw_leaf_views_first(&n->leaves, t);
		for (uint32_t octant = 0; octant < 8; octant++) {
			if ((bits >> octant & 1u) == 0)
				continue;
			bool has_facet = ((bits >> 8 | bits >> 16) >> octant & 1u) != 0;
			if (!has_facet && is_before(n, leaf))
				c->leaves[t] &= (uint8_t) ~(1u << octant);
			leaf++;
		}
	}
}

static gw_status open_views(gw_gpu *gpu, const gw_octree *o, size_t surfels, near_leaves *n,
							gw_error *error)
{
	uint64_t bytes = 16 * (uint64_t)surfels;
	GW_TRY(gw_leaf_views_open(gpu, o, &n->leaves, error));
	GW_TRY(gw_view_open(gpu, &o->leaf_cell, 16 * (uint64_t)o->leaf_count, &n->cell, error));
	GW_TRY(gw_view_open(gpu, &o->surfel_position, bytes, &n->place, error));
	return gw_view_open(gpu, &o->surfel_normal, bytes, &n->normal, error);
}

gw_status gw_compartments_open_near(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels,
									gw_compartments *c, gw_error *error)
{
	near_leaves n = { 0 };
	gw_status status = open_views(gpu, octree, surfels->count, &n, error);
	if (status == GW_OK)
		open_near_leaves(&n, octree->leaf_tile_count, c);
	gw_leaf_views_close(&n.leaves);
	gw_view_close(&n.cell);
	gw_view_close(&n.place);
	gw_view_close(&n.normal);
	return status;
}
