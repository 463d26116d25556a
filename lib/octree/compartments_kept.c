/*
 * compartments_kept.c - see compartments_kept.h.
 */
#include "octree/compartments_kept.h"

#include "base/memory.h"
#include "octree/compartments_steps.h"

#include <stdlib.h>

gw_compartments_numbers gw_compartments_numbers_of(const gw_octree *octree)
{
	const gw_compartments *c = octree->compartments;
	if (octree->coarser != NULL || c == NULL)
		return (gw_compartments_numbers){ .known = GW_COMPARTMENTS_NOT_FOUND };
	if (!gw_compartments_several(octree))
		return (gw_compartments_numbers){ .known = GW_COMPARTMENTS_ONE };
	return (gw_compartments_numbers){ .known = GW_COMPARTMENTS_SEVERAL,
									  .tiles = c->first / 8,
									  .count = c->count };
}

bool gw_compartments_numbers_fit(const gw_compartments_numbers *n, uint32_t tiles,
								 uint32_t leaf_tiles)
{
	if (n->known != GW_COMPARTMENTS_SEVERAL)
		return n->known <= GW_COMPARTMENTS_ONE && n->tiles == 0 && n->count == 0;
	uint64_t cells = 8 * ((uint64_t)n->tiles + leaf_tiles);
	return n->tiles >= tiles && cells < GW_COMPARTMENT_UNKNOWN && n->count > 0 &&
		   n->count <= cells + 1;
}

gw_status gw_compartments_restore(const gw_compartments_numbers *n, gw_octree *octree,
								  gw_error *error)
{
	if (n->known == GW_COMPARTMENTS_NOT_FOUND)
		return GW_OK;
	gw_compartments *c = octree->compartments = gw_allocate_zeros(1, sizeof *c);
	if (c == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for compartments");
	c->depth = octree->depth;
	c->first = 8 * n->tiles;
	c->cells = c->first + 8 * octree->leaf_tile_count;
	c->count = n->count;
	return GW_OK;
}

void gw_compartments_list(gw_octree *octree, size_t surfels,
						  gw_compartments_array list[GW_COMPARTMENTS_ARRAYS])
{
	gw_compartments *c = octree->compartments;
	const gw_compartments_array all[GW_COMPARTMENTS_ARRAYS] = {
		{ "tree of compartments", &c->child, 4 * (uint64_t)c->first, false },
		{ "leaves of compartments", &c->leaves, octree->leaf_tile_count, false },
		{ "compartments of cells", &c->label, 4 * ((uint64_t)c->cells + 1), true },
		{ "compartments of surfels", &c->sides, 8 * (uint64_t)surfels, true },
		{ "compartments of facets", &octree->facet_compartment, 4 * (uint64_t)octree->facet_count,
		  true },
	};
	for (size_t i = 0; i < GW_COMPARTMENTS_ARRAYS; i++)
		list[i] = all[i];
}

/* Reaches the children of some tiles of a level, which they follow in `reached`, all of whose tiles
 * are marked as seen. */
static bool reach_children(const gw_compartments *c, uint32_t level, uint32_t from, uint32_t *count,
						   uint32_t *reached, uint8_t *seen)
{
	uint32_t leaf_tiles = (c->cells - c->first) / 8;
	for (uint32_t end = *count; from < end; from++) {
		for (uint32_t k = 0; k < 8; k++) {
			uint32_t to = c->child[8 * reached[from] + k];
			if (to == 0 || to == GW_WALL)
				continue;
			if (level + 2 == c->depth) {
				if (to > leaf_tiles)
					return false;
				continue;
			}
			if (to > c->first / 8 || seen[to - 1])
				return false;
			seen[to - 1] = 1;
			reached[(*count)++] = to - 1;
		}
	}
	return true;
}

gw_status gw_compartments_fit(const gw_octree *octree, bool *fit, gw_error *error)
{
	const gw_compartments *c = octree->compartments;
	*fit = true;
	if (!gw_compartments_several(octree))
		return GW_OK;
	uint32_t *reached = gw_allocate_array(c->first / 8, sizeof *reached);
	uint8_t *seen = gw_allocate_zeros(c->first / 8, 1);
	gw_status status =
		reached && seen ? GW_OK
						: gw_fail(error, GW_ERROR_MEMORY, "no memory to check %u cells", c->cells);
	*fit = c->label[c->cells] == 0 && c->depth >= 2;
	if (status == GW_OK) {
		uint32_t count = 1, from = 0;
		reached[0] = 0;
		seen[0] = 1;
		for (uint32_t level = 0; level + 2 <= c->depth && *fit; level++) {
			uint32_t next = count;
			*fit = reach_children(c, level, from, &count, reached, seen);
			from = next;
		}
	}
	free(reached);
	free(seen);
	return status;
}
