/*
 * compartments.c - see compartments.h: which compartment something lies in, once they are found.
 */
#include "octree/compartments_steps.h"

#include <stdlib.h>

gw_compartment_cell gw_compartment_child(const gw_compartments *c, gw_compartment_cell of,
										 uint32_t octant)
{
	uint32_t number = 8 * (of.tile - 1) + octant, level = of.level + 1;
	if (level < c->depth)
		return (gw_compartment_cell){ number, c->child[number], level };
	bool wall = (uint32_t)c->leaves[of.tile - 1] >> octant & 1u;
	return (gw_compartment_cell){ c->first + number, wall ? GW_WALL : 0, level };
}

gw_status gw_leaf_views_open(gw_gpu *gpu, const gw_octree *octree, gw_leaf_views *views,
							 gw_error *error)
{
	*views = (gw_leaf_views){ 0 };
	GW_TRY(gw_view_open(gpu, &octree->leaf_tile, 8 * (uint64_t)octree->leaf_tile_count,
						&views->tile, error));
	GW_TRY(gw_view_open(gpu, &octree->facet_leaf, 4 * (uint64_t)octree->facet_count, &views->leaf,
						error));
	GW_TRY(gw_view_open(gpu, &octree->leaf_fragment, 4 * ((uint64_t)octree->leaf_count + 1),
						&views->first, error));
	return gw_view_open(gpu, &octree->fragment_surfel, 4 * (uint64_t)octree->fragment_count,
						&views->fragment, error);
}

void gw_leaf_views_close(gw_leaf_views *views)
{
	gw_view_close(&views->tile);
	gw_view_close(&views->leaf);
	gw_view_close(&views->first);
	gw_view_close(&views->fragment);
}

void gw_compartments_drop_necks(gw_compartments *c)
{
	free(c->node_neck);
	free(c->leaf_neck);
	c->node_neck = c->leaf_neck = NULL;
}

void gw_compartments_drop_cells(gw_compartments *c)
{
	free(c->child);
	free(c->leaves);
	free(c->label);
	gw_compartments_drop_necks(c);
	c->child = c->label = NULL;
	c->leaves = NULL;
}

void gw_compartments_destroy(gw_compartments **compartments)
{
	if (*compartments == NULL)
		return;
	gw_compartments_drop_cells(*compartments);
	free((*compartments)->sides);
	free(*compartments);
	*compartments = NULL;
}

/* The leaf tile of a cell plus one, 0 where there is none, or GW_WALL. */
static uint32_t find_leaf_tile(const gw_compartments *c, const int32_t at[3])
{
	uint32_t tile = 1;
	for (uint32_t shift = c->depth - 1; shift > 0 && tile != 0 && tile != GW_WALL; shift--) {
		uint32_t octant = (uint32_t)(at[0] >> shift & 1) | (uint32_t)(at[1] >> shift & 1) << 1 |
						  (uint32_t)(at[2] >> shift & 1) << 2;
		tile = c->child[8 * (tile - 1) + octant];
	}
	return tile;
}

uint32_t gw_compartment_leaf_tile(const gw_compartments *c, const int32_t at[3])
{
	uint32_t tile = find_leaf_tile(c, at);
	return tile == GW_WALL ? 0 : tile;
}

bool gw_compartment_lies_in_wall(const gw_compartments *c, const int32_t at[3])
{
	for (int k = 0; k < 3; k++)
		if (at[k] < 0 || at[k] >= 1 << c->depth)
			return false;
	return find_leaf_tile(c, at) == GW_WALL;
}

uint32_t gw_compartment_of_cell(const gw_compartments *c, const int32_t at[3])
{
	gw_compartment_cell of = { 0, 1, 0 };
	for (int k = 0; k < 3; k++)
		if (at[k] < 0 || at[k] >= 1 << c->depth)
			return c->label[c->cells];
	for (uint32_t level = 0; level < c->depth; level++) {
		uint32_t shift = c->depth - 1 - level;
		uint32_t octant = (uint32_t)(at[0] >> shift & 1) | (uint32_t)(at[1] >> shift & 1) << 1 |
						  (uint32_t)(at[2] >> shift & 1) << 2;
		of = gw_compartment_child(c, of, octant);
		if (of.tile == 0)
			return c->label[of.number];
		if (of.tile == GW_WALL)
			break;
	}
	return GW_COMPARTMENT_UNKNOWN;
}

const gw_octree *gw_compartments_octree(const gw_octree *octree)
{
	return octree->coarser ? octree->coarser : octree;
}

void gw_compartments_place(const gw_octree *octree, const float g[3], float place[3])
{
	const gw_octree *to = gw_compartments_octree(octree);
	for (int k = 0; k < 3; k++)
		place[k] =
			to == octree
				? g[k]
				: (octree->cube_minimum[k] - to->cube_minimum[k] + g[k] * octree->leaf_size) /
					  to->leaf_size;
}

bool gw_compartments_several(const gw_octree *octree)
{
	const gw_compartments *c = gw_compartments_octree(octree)->compartments;
	return c != NULL && c->sides != NULL;
}

uint32_t gw_compartments_count(const gw_octree *octree)
{
	return gw_compartments_octree(octree)->compartments->count;
}

uint32_t gw_compartment_outside(const gw_octree *octree)
{
	const gw_compartments *c = gw_compartments_octree(octree)->compartments;
	return c->label[c->cells];
}

uint32_t gw_compartment_at(const gw_octree *octree, const float g[3])
{
	const gw_octree *of = gw_compartments_octree(octree);
	float place[3];
	int32_t at[3];
	gw_compartments_place(octree, g, place);
	for (int k = 0; k < 3; k++) {
		float side = (float)(1u << of->depth);
		at[k] = place[k] >= 0.0f && place[k] < side ? (int32_t)place[k] : -1;
	}
	return gw_compartment_of_cell(of->compartments, at);
}

const uint32_t *gw_compartments_of_facets(const gw_octree *octree)
{
	return octree->facet_compartment;
}

uint32_t gw_compartment_of_surfel(const gw_octree *octree, size_t surfel, bool back)
{
	return gw_compartments_octree(octree)->compartments->sides[2 * surfel + (back ? 1 : 0)];
}
