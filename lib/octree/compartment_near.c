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
	gw_view tile, cell, first, fragment, place, normal;
} near_leaves;

/* Does a leaf lie before the planes of all surfels that count in it? */
static bool is_before(const near_leaves *n, uint32_t leaf)
{
	const int32_t *cell = (const int32_t *)n->cell.bytes + 4 * (size_t)leaf;
	const uint32_t *first = n->first.bytes, *fragment = n->fragment.bytes;
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
	const uint32_t *tile = n->tile.bytes;
	for (uint32_t t = 0; t < leaf_tiles; t++) {
		uint32_t leaf = tile[2 * t], bits = tile[2 * t + 1];
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

gw_status gw_compartments_open_near(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels,
									gw_compartments *c, gw_error *error)
{
	near_leaves n = { 0 };
	uint64_t leaves = octree->leaf_count, bytes = 16 * (uint64_t)surfels->count;
	gw_status status = gw_view_open(gpu, &octree->leaf_tile, 8 * (uint64_t)octree->leaf_tile_count,
									&n.tile, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->leaf_cell, 16 * leaves, &n.cell, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->leaf_fragment, 4 * (leaves + 1), &n.first, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->fragment_surfel, 4 * (uint64_t)octree->fragment_count,
							  &n.fragment, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->surfel_position, bytes, &n.place, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->surfel_normal, bytes, &n.normal, error);
	if (status == GW_OK)
		open_near_leaves(&n, octree->leaf_tile_count, c);
	gw_view_close(&n.normal);
	gw_view_close(&n.place);
	gw_view_close(&n.fragment);
	gw_view_close(&n.first);
	gw_view_close(&n.cell);
	gw_view_close(&n.tile);
	return status;
}
