/*
 * octree_numbers.glsl - the numbers of facets (octree.h): of a leaf, by its tile, and the other
 * way, by what facet_leaf has of a facet, which whoever asks fetches.
 */
#ifndef OCTREE_NUMBERS_GLSL
#define OCTREE_NUMBERS_GLSL

#include "octree/octree_layout.h"

/* The number of the first facet of a tile's leaf; that of a second one comes next. */
uint first_facet(uvec2 tile, uint octant)
{
	uint below = (1u << octant) - 1u;
	return tile.x + uint(bitCount(tile.y & (below | below << 16)));
}

bool has_second(uvec2 tile, uint octant)
{
	return (tile.y >> (16u + octant) & 1u) != 0u;
}

/* The leaf of a facet, by its word of facet_leaf. */
uint leaf_of(uint word)
{
	return word & GW_FACET_LEAF;
}

bool is_second(uint word)
{
	return (word & GW_FACET_SECOND) != 0u;
}

/* Has a fragment joined such a facet of its leaf, as one of its discs? */
bool is_disc_of(uint word, uint fragment)
{
	return (fragment & GW_FRAGMENT_ROI) == 0u &&
		   ((fragment & GW_FRAGMENT_FACET) != 0u) == is_second(word);
}

/* A facet, and its word of facet_leaf. */
struct Owner {
	uint facet, word;
};

/* The facet that a disc fragment has joined, of the leaf of a first one. */
Owner owner_joined(Owner first, uint fragment)
{
	bool second = (fragment & GW_FRAGMENT_FACET) != 0u;
	Owner owner = { first.facet + (second ? 1u : 0u),
					first.word | (second ? GW_FACET_SECOND : 0u) };
	return owner;
}

#endif
