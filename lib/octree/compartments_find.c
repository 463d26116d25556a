/*
 * compartments_find.c - empty cells of all sizes that touch by a face are united while the octree
 * is walked from its root: of two cells beside each other their children that touch, and so on,
 * until both are empty or one of them is a wall. So nothing is searched for.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"
#include "octree/octree_layout.h"

#include <stdlib.h>
#include <string.h>

static const gw_compartment_cell root = { GW_COMPARTMENT_UNKNOWN, 1, 0 };

/* Is a cell empty, or one within it, that is not joined to what lies around the scene? */
static bool is_any_apart(const gw_compartments *c, gw_compartment_cell of)
{
	if (of.tile == 0)
		return c->label[of.number] != c->label[c->cells];
	for (uint32_t octant = 0; octant < 8 && of.tile != GW_WALL; octant++)
		if (is_any_apart(c, gw_compartment_child(c, of, octant)))
			return true;
	return false;
}

/* Of nodes only those that hold something have children here: others are there to be filtered
 * across. Tiles come level by level, the root first. */
static void take_tree(const gw_octree *octree, const uint32_t *node, gw_compartments *c)
{
	for (uint32_t level = octree->depth - 1; level > 0; level--) {
		for (uint32_t t = octree->tile_first[level]; t < octree->tile_first[level + 1]; t++) {
			for (uint32_t i = 8 * t; i < 8 * t + 8; i++) {
				uint32_t to = node[i];
				bool holds = false;
				if (to != 0 && level == octree->depth - 1)
					holds = c->leaves[to - 1] != 0;
				for (uint32_t k = 0; to != 0 && level < octree->depth - 1 && k < 8; k++)
					holds |= c->child[8 * (to - 1) + k] != 0;
				c->child[i] = holds ? to : 0;
			}
		}
	}
}

/* Leaves in which all surface lets light through are no walls. */
static void open_leaves(const gw_surfels *surfels, const gw_leaf_views *views, uint32_t leaf_tiles,
						gw_compartments *c)
{
	const uint32_t *leaf_tile = views->tile.bytes, *first = views->first.bytes;
	const uint32_t *fragment = views->fragment.bytes;
	for (uint32_t t = 0; t < leaf_tiles; t++) {
		size_t leaf = gw_leaf_views_first(views, t);
		for (uint32_t octant = 0; octant < 8; octant++) {
			if ((leaf_tile[2 * t + 1] >> octant & 1u) == 0)
				continue;
			bool clear = true;
			for (uint32_t f = first[leaf]; f < first[leaf + 1] && clear; f++)
				clear = surfels->transparency[fragment[f] & GW_FRAGMENT_SURFEL] > 0.0f;
			if (clear)
				c->leaves[t] &= (uint8_t) ~(1u << octant);
			leaf++;
		}
	}
}

static gw_status find_open_leaves(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels,
								  gw_compartments *c, gw_error *error)
{
	gw_leaf_views views;
	gw_status status = gw_leaf_views_open(gpu, octree, &views, error);
	if (status == GW_OK)
		open_leaves(surfels, &views, octree->leaf_tile_count, c);
	gw_leaf_views_close(&views);
	return status;
}

static gw_status fetch_leaves(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels,
							  gw_compartments *c, gw_error *error)
{
	gw_view tile;
	GW_TRY(
		gw_view_open(gpu, &octree->leaf_tile, 8 * (uint64_t)octree->leaf_tile_count, &tile, error));
	for (uint32_t t = 0; t < octree->leaf_tile_count; t++)
		c->leaves[t] = (uint8_t)((const uint32_t *)tile.bytes)[2 * t + 1];
	gw_view_close(&tile);
	GW_TRY(gw_compartments_open_near(gpu, octree, surfels, c, error));
	return surfels->transparency ? find_open_leaves(gpu, octree, surfels, c, error) : GW_OK;
}

static gw_status fetch_tree(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels,
							gw_compartments *c, gw_error *error)
{
	gw_view node;
	GW_TRY(fetch_leaves(gpu, octree, surfels, c, error));
	GW_TRY(gw_view_open(gpu, &octree->node, 32 * (uint64_t)octree->tile_count, &node, error));
	take_tree(octree, node.bytes, c);
	gw_view_close(&node);
	return GW_OK;
}

static gw_status make(const gw_octree *octree, gw_compartments **made, gw_error *error)
{
	uint64_t cells = 8 * ((uint64_t)octree->tile_count + octree->leaf_tile_count);
	gw_compartments *c = *made = gw_allocate_zeros(1, sizeof *c);
	if (c != NULL && cells < GW_COMPARTMENT_UNKNOWN) {
		c->depth = octree->depth;
		c->first = 8 * octree->tile_count;
		c->child = gw_allocate_array(c->first, sizeof *c->child);
		c->leaves = gw_allocate_array(octree->leaf_tile_count, 1);
		if (c->child && c->leaves)
			return GW_OK;
	}
	gw_compartments_destroy(made);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the compartments of %llu cells",
				   (unsigned long long)cells);
}

/* Numbers in place of labels: first the space around the scene, then what surfels look into, in
 * their order, and one for all that none looks into. */
static gw_status number_them(gw_compartments *c, size_t surfels, gw_error *error)
{
	uint32_t *number = gw_allocate_array((size_t)c->cells + 1, sizeof *number);
	if (number == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u compartments", c->cells);
	memset(number, 0xff, ((size_t)c->cells + 1) * sizeof *number);
	number[c->label[c->cells]] = c->count++;
	for (size_t i = 0; i < 2 * surfels; i++) {
		uint32_t label = c->sides[i];
		if (label == GW_COMPARTMENT_UNKNOWN)
			continue;
		if (number[label] == GW_COMPARTMENT_UNKNOWN)
			number[label] = c->count++;
		c->sides[i] = number[label];
	}
	for (uint32_t i = 0; i <= c->cells; i++)
		if (c->label[i] != GW_COMPARTMENT_UNKNOWN)
			c->label[i] =
				number[c->label[i]] == GW_COMPARTMENT_UNKNOWN ? c->count : number[c->label[i]];
	c->count++;
	free(number);
	return GW_OK;
}

/* Octrees may be so many levels deeper than their points ask for: further down random points leave
 * voids that are wider than cells, at creases above all. Of ten closed rooms of 3,000 points all
 * are closed 1 below, six 2, five 3 and two 4 below. */
#define LEVELS_BELOW 1u

bool gw_compartments_are_coarser(const gw_octree *octree, const gw_surfels *surfels)
{
	return octree->depth > gw_octree_auto_depth(surfels) + LEVELS_BELOW;
}

static gw_status find_in_own_cells(gw_gpu *gpu, const gw_surfels *surfels, uint32_t threads,
								   gw_octree *octree, gw_error *error)
{
	gw_compartments *c = NULL;
	if (octree->depth < 2) /* The root's children are leaves, in which nothing is kept apart. */
		return GW_OK;
	GW_TRY(make(octree, &c, error));
	gw_status status = fetch_tree(gpu, octree, surfels, c, error);
	if (status == GW_OK)
		status = gw_compartments_close_voids(gpu, octree, c, error);
	if (status == GW_OK)
		status = gw_compartments_wall_discs(gpu, octree, surfels, threads, c, error);
	if (status == GW_OK)
		status = gw_compartments_close_sparse(gpu, octree, surfels, threads, c, error);
	if (status == GW_OK)
		status = gw_compartments_close_voids_again(gpu, octree, c, error);
	if (status == GW_OK)
		status = gw_compartments_find_necks(gpu, octree, surfels, threads, c, error);
	if (status == GW_OK)
		status = gw_compartments_join(gpu, octree, surfels->count, threads, c, error);
	if (status == GW_OK && is_any_apart(c, root))
		status = gw_compartments_find_sides(gpu, octree, surfels->count, threads, c, error);
	if (status == GW_OK && c->sides != NULL)
		status = number_them(c, surfels->count, error);
	if (status != GW_OK) {
		gw_compartments_destroy(&c);
		return status;
	}
	if (c->sides == NULL)
		gw_compartments_drop_cells(c);
	octree->compartments = c;
	return GW_OK;
}

static gw_status find_in_coarser(gw_gpu *gpu, const gw_surfels *surfels, uint32_t threads,
								 gw_octree *octree, gw_error *error)
{
	gw_octree *coarser = gw_allocate_zeros(1, sizeof *coarser);
	if (coarser == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for an octree");
	const gw_octree_task task = { .surfels = surfels, .leaf_spacing = GW_LEAF_SPACING };
	gw_status status = gw_octree_build_task(gpu, &task, coarser, error);
	if (status == GW_OK)
		status = find_in_own_cells(gpu, surfels, threads, coarser, error);
	if (status == GW_OK) {
		gw_compartments_drop_rest(gpu, coarser);
		octree->coarser = coarser;
		return GW_OK;
	}
	gw_octree_destroy(gpu, coarser);
	free(coarser);
	return status;
}

/* The compartments of facets, which then have no light but theirs. */
static gw_status label_facets(gw_gpu *gpu, const gw_surfels *surfels, gw_octree *octree,
							  gw_error *error)
{
	GW_TRY(gw_compartments_label_facets(gpu, octree, error));
	return gw_compartments_part_facets(gpu, surfels, octree, error);
}

gw_status gw_compartments_find(gw_gpu *gpu, const gw_surfels *surfels, uint32_t threads,
							   gw_octree *octree, gw_error *error)
{
	bool known = octree->compartments != NULL || octree->coarser != NULL;
	if (known && (octree->facet_compartment || !gw_compartments_several(octree)))
		return GW_OK;
	if (known)
		return label_facets(gpu, surfels, octree, error);
	if (surfels->clip && gw_compartments_are_coarser(octree, surfels))
		GW_TRY(find_in_coarser(gpu, surfels, threads, octree, error));
	else
		GW_TRY(find_in_own_cells(gpu, surfels, threads, octree, error));
	return gw_compartments_several(octree) ? label_facets(gpu, surfels, octree, error) : GW_OK;
}
