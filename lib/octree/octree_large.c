/*
 * octree_large.c - the tree of the discs that are too large for leaves; see octree_steps.h.
 */
#include "octree/octree_steps.h"

#include "normals/disc_tree.h"
#include "base/memory.h"
#include "light/transport_layout.h"

#include <stdlib.h>

float gw_octree_disc_most(const gw_surfels *surfels)
{
	return surfels->disc_most > 0.0f ? surfels->disc_most : (float)GW_DISC_MAX;
}

/* As convert of octree_fragments.c and its shader see it. */
bool gw_octree_disc_is_large(const gw_octree *octree, const gw_surfels *surfels, size_t surfel)
{
	double leaf = (double)octree->leaf_size, side = (double)(1u << octree->depth);
	for (size_t k = 0; k < 3; k++) {
		double cell =
			((double)surfels->position[3 * surfel + k] - (double)octree->cube_minimum[k]) / leaf;
		if (!(cell >= 0 && cell <= side))
			return false;
	}
	return surfels->two_sided[surfel] != GW_SIDE_BACK &&
		   (float)((double)surfels->radius[surfel] / leaf) > gw_octree_disc_most(surfels);
}

static void enter_facets(const gw_octree *octree, const uint32_t *leaf_of, const uint32_t *first,
						 const uint32_t *surfel, uint32_t *facet)
{
	for (uint32_t i = GW_FACET_EMPTY + 1; i < octree->facet_count; i++) {
		size_t leaf = gw_facet_leaf(leaf_of[i]);
		for (uint32_t f = first[leaf]; f < first[leaf + 1]; f++) {
			uint32_t *own = facet + (surfel[f] & GW_FRAGMENT_SURFEL);
			if (gw_facet_holds(leaf_of[i], surfel[f]) && *own == GW_NONE)
				*own = i;
		}
	}
}

/* Enters the facets that stand for surfels: those of their first disc fragments. */
static gw_status find_facets(gw_octree_work *work, uint32_t *facet, gw_error *error)
{
	const gw_octree *octree = work->octree;
	gw_view first = { 0 }, surfel = { 0 }, leaf = { 0 };
	gw_status status = gw_view_open(work->gpu, &octree->leaf_fragment,
									4 * ((uint64_t)octree->leaf_count + 1), &first, error);
	if (status == GW_OK)
		status = gw_view_open(work->gpu, &octree->facet_leaf, 4 * (uint64_t)octree->facet_count,
							  &leaf, error);
	if (status == GW_OK)
		status = gw_view_open(work->gpu, &octree->fragment_surfel,
							  4 * (uint64_t)octree->fragment_count, &surfel, error);
	if (status == GW_OK)
		enter_facets(octree, leaf.bytes, first.bytes, surfel.bytes, facet);
	gw_view_close(&first);
	gw_view_close(&leaf);
	gw_view_close(&surfel);
	return status;
}

gw_disc_shape gw_octree_disc_shape(const gw_octree *octree)
{
	const float *low = octree->cube_minimum;
	return (gw_disc_shape){ .scale = 1 / (double)octree->leaf_size,
							.origin = { (double)low[0], (double)low[1], (double)low[2] },
							.widen = 1 };
}

/* The large discs in coordinates of the grid; returns how many. */
static size_t list_large(const gw_octree_work *work, const uint32_t *facet, gw_disc *disc)
{
	const gw_octree *octree = work->octree;
	const gw_disc_shape shape = gw_octree_disc_shape(octree);
	size_t count = 0;
	for (size_t i = 0; i < work->surfels->count; i++) {
		if (!gw_octree_disc_is_large(octree, work->surfels, i))
			continue;
		disc[count] = gw_disc_of_surfel(work->surfels, i, &shape);
		disc[count++].facet = facet[i];
	}
	return count;
}

static gw_status fill_tree(gw_octree_work *work, uint32_t *facet, gw_disc *disc, gw_disc_tree *tree,
						   gw_error *error)
{
	if (!facet || !disc)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u large discs",
					   work->octree->tree_discs);
	for (size_t i = 0; i < work->surfels->count; i++)
		facet[i] = GW_NONE;
	GW_TRY(find_facets(work, facet, error));
	return gw_disc_tree_build(disc, list_large(work, facet, disc), tree, error);
}

static gw_status make_tree(gw_octree_work *work, gw_disc_tree *tree, gw_error *error)
{
	uint32_t *facet = gw_allocate_array(work->surfels->count, sizeof *facet);
	gw_disc *disc = gw_allocate_array(work->octree->tree_discs, sizeof *disc);
	gw_status status = fill_tree(work, facet, disc, tree, error);
	free(facet);
	free(disc);
	return status;
}

gw_status gw_octree_plant_discs(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_disc_tree tree = { 0 };
	const uint32_t none[4] = { 0 };
	octree->tree_discs = 0;
	for (size_t i = 0; i < work->surfels->count; i++)
		octree->tree_discs += gw_octree_disc_is_large(octree, work->surfels, i);
	gw_status status = octree->tree_discs > 0 ? make_tree(work, &tree, error) : GW_OK;
	octree->tree_nodes = tree.nodes;
	uint64_t bytes = 16 * gw_disc_tree_texels(tree.discs, tree.nodes);
	if (status == GW_OK)
		status = gw_octree_buffer(work, VK_FORMAT_R32G32B32A32_UINT, bytes, "tree of large discs",
								  &octree->disc_tree, error);
	if (status == GW_OK)
		status = gw_buffer_upload(work->gpu, &octree->disc_tree, 0, tree.word ? tree.word : none,
								  bytes, error);
	gw_disc_tree_clear(&tree);
	return status;
}
