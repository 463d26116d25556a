/*
 * octree_layout.h - push-constant blocks of the passes that build the octree, shared by C and GLSL.
 *
 * Every block starts with the span that the device layer fills (gpu.h). Keys are Morton keys.
 */
#ifndef OCTREE_LAYOUT_H
#define OCTREE_LAYOUT_H

#include "base/shared_types.h"

/* Fragments of one leaf that are reduced by one invocation. */
#define GW_REDUCE_RUN 2048u

/* Disc radius in leaf cells: the largest that leaves hold where the scene says nothing else, larger
 * ones are in a tree of their own; and the largest that is sampled by fixed points. */
#define GW_DISC_MAX 8.0
#define GW_DISC_SMALL 1.0

/* Distance where there is nothing within the octree. */
#define GW_DISTANCE_FAR 255

/* Bits of fragment_surfel. */
#define GW_FRAGMENT_SURFEL 0x3fffffffu
#define GW_FRAGMENT_FACET 0x40000000u
#define GW_FRAGMENT_ROI 0x80000000u

/* The number of the facet that is empty (octree.h). */
#define GW_FACET_EMPTY 0u

/* Parts of facet_leaf: the leaf of a facet, and whether it is the second one there. */
#define GW_FACET_LEAF 0x7fffffffu
#define GW_FACET_SECOND 0x80000000u

/* What w of a surfel's normal says, besides 1: all its cuts are at creases; nobody knows which side
 * is its front, which counts less than half of what w = 1 does; it is the back of such a one; it is
 * foliage, which makes a facet foliage where all of it is that. */
#define GW_MARK_CREASED -1.0f
#define GW_MARK_UNCLEAR 0.25f
#define GW_MARK_BACK -2.0f
#define GW_MARK_FOLIAGE 4.0f

/* What w of a facet's albedo is at least, besides 0 and 1, where some of it may face either way. */
#define GW_FACET_UNCLEAR 2.0f

/* Words in which octree_fragments.comp notes what a disc meets, eight columns of cells each. */
#define GW_COLUMN_WORDS 8u

/* What octree_fragments.comp does: counts fragments, writes their keys, or all else of them. */
#define GW_EMIT_COUNTS 0u
#define GW_EMIT_KEYS 1u
#define GW_EMIT_REST 2u

SHARED_STRUCT(gw_fragments_push)
{
	uint first, count;
	uint side;       /* leaf cells */
	uint emit;       /* one of those below */
	uint wide;       /* keys have a high word */
	uint base;       /* the surfel that element 0 is */
	float disc_most; /* radius, leaf cells: of a larger disc one leaf holds all the area */
	uint regions;    /* 1: regions of influence have fragments, too */
};
SHARED_SIZE(gw_fragments_push, 32);

/* Distinct keys, and lists of keys. */
SHARED_STRUCT(gw_keys_push)
{
	uint first, count;
	uint shift; /* bits that keys are shifted right by: 0 or 3 */
	uint split; /* the high words are in a list of their own */
	uint total; /* elements */
};
SHARED_SIZE(gw_keys_push, 20);

SHARED_STRUCT(gw_border_push)
{
	uint first, count;
	uint cells; /* that the tiles hold, all together */
	uint emit;  /* 0: count; 1: write */
	uint wide;
	uint base; /* write: first element */
	uint tiles;
};
SHARED_SIZE(gw_border_push, 28);

SHARED_STRUCT(gw_tiles_push)
{
	uint first, count;
	uint level;        /* of the tiles' parent cells */
	uint tile_first;   /* pointer to the first of these tiles */
	uint parent_first; /* pointer to the first tile of the level above */
	uint parent_count; /* how many; 0: this is the root */
	uint directory;    /* 1: there is a directory of this level */
	uint total;        /* tiles */
};
SHARED_SIZE(gw_tiles_push, 32);

SHARED_STRUCT(gw_leaves_push)
{
	uint first, count;
	uint leaves;
	uint from; /* reduction: first fragment of each leaf to be reduced now */
	uint emissive;
	uint depth;
	uint directory_level;
};
SHARED_SIZE(gw_leaves_push, 28);

SHARED_STRUCT(gw_distance_push)
{
	uint first, count;
	uint level; /* of the cells */
};
SHARED_SIZE(gw_distance_push, 12);

#endif
