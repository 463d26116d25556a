/*
 * octree.h - the sparse voxel octree on the device (Salm 2015, section 4.3).
 *
 * Terms, after the thesis. The octree's cube has 2^depth leaf cells a side; a node of level l is
 * one of (2^l)^3 cells. A tile is the group of the eight children of one node, in Morton order; the
 * root tile holds the eight nodes of level 1 and is tile 0. A node holds one tile pointer, which
 * also addresses the brick of 3x3x3 voxels of that tile (8 own voxels and 19 that repeat the
 * neighbours' on the positive sides, so that hardware can filter across bricks). Tiles whose nodes
 * are leaves are leaf tiles: they have an address space and brick pool of their own and store no
 * nodes, only a bit field that says which leaves exist. Where a sample that falls into the half
 * voxel on a tile's negative side would miss a tile, an empty border tile is added.
 *
 * The build is sort-based: fragments (sample, leaf) sorted by Morton key give leaves, leaves give
 * leaf tiles, these the tiles of each level above; counts are known before anything is allocated
 * and the result does not depend on scheduling. Coordinates: grid coordinates g = (p -
 * cube_minimum) / leaf_size, in [0, 2^depth); the Morton key of a cell interleaves z, y, x with x
 * lowest: bit 3i is bit i of x, 3i+1 of y, 3i+2 of z; octant = x | y << 1 | z << 2.
 */
#ifndef OCTREE_H
#define OCTREE_H

#include "device/gpu.h"
#include "cloud/surfels.h"
#include "normals/disc_tree.h"
#include "octree/octree_layout.h"

#include <math.h>

/* Directory: dense tables of tile pointers down to this level, so that a walk need not start at
 * the root. */
#define GW_DIRECTORY_LEVEL_MAX 7u

/* Room for a sentence. */
#define GW_OCTREE_WHY 512

typedef struct gw_octree {
	uint32_t depth;
	/* metres */
	float leaf_size;
	/* metres; 0 where leaves are as wide as they were to be, else how wide that is: memory or a
	 * limit of the device did not allow for it, and why says which */
	float wanted_leaf_size;
	char why_coarser[GW_OCTREE_WHY];
	/* local frame, metres; at least two leaf cells below the bounds */
	float cube_minimum[3];
	/* T = min(depth - 1, GW_DIRECTORY_LEVEL_MAX) */
	uint32_t directory_level;

	uint32_t leaf_count;
	/* numbers of facets, of which GW_FACET_EMPTY is that of the empty one */
	uint32_t facet_count;
	/* with border tiles */
	uint32_t leaf_tile_count;
	/* non-leaf tiles of all levels, with border tiles */
	uint32_t tile_count;
	/* of both kinds */
	uint32_t border_tile_count;
	uint32_t fragment_count;
	/* surfels whose disc is larger than leaves hold, and nodes of their tree */
	uint32_t tree_discs, tree_nodes;
	/* 0 where all is opaque; else 1 + the number of the empty facet, which sends out nothing: what
	 * rays find that are stopped by the back of a surface that others pass */
	uint32_t dark_facet;
	/* tiles of level l (whose nodes are of level l) are tile_first[l] .. tile_first[l + 1] -
	 * 1; l = 1..depth - 1 */
	uint32_t tile_first[GW_DEPTH_MAX + 2];

	/* Tree. Pointers are stored plus one; 0 means none. */
	/* R32_UINT, 8 * tile_count: pointer to the child tile; at level depth - 1 to the leaf tile */
	gw_buffer node;
	/* R32G32_UINT, tile_count: Morton key of the tile's parent cell (level l - 1) */
	gw_buffer tile_key;
	/* R32_UINT, 8 * tile_count: [octant]: pointer (plus one) to the tile of the same level one
	 * tile further along the axes in octant (1 = +x, 3 = +x+y, ...; [0] is the tile itself) */
	gw_buffer tile_neighbour;
	/* R32G32_UINT, leaf_tile_count: Morton key of its parent cell (level depth - 1) */
	gw_buffer leaf_tile_key;
	/* R32_UINT, 8 * leaf_tile_count, as tile_neighbour */
	gw_buffer leaf_tile_neighbour;
	/* R32G32_UINT, leaf_tile_count: x = number of its first leaf's first facet (0 where it has no
	 * leaves), y = bit field: bits 0-7 leaf exists, bits 8-15 it has a first facet, 16-23 a second
	 * one, 24-31 its facets' surface fills it */
	gw_buffer leaf_tile;
	/* R32G32B32A32_UINT, leaf_count: cell x, y, z and leaf tile */
	gw_buffer leaf_cell;

	/* Directory. level_directory: for t = 0..T, entry (8^t - 1) / 7 + x + (y << t) + (z << 2t) is
	 * the pointer (plus one) to the tile of that cell's children (a leaf tile where t = depth - 1).
	 * ray_directory: for level T alone; bit 31 set: the cell holds leaves with facets, low bits are
	 * the pointer (not plus one) to its children's tile; else the chessboard distance, in cells of
	 * level T and at most 255, to the nearest cell that holds some. */
	/* R32_UINT */
	gw_buffer level_directory;
	/* R32_UINT, 8^T */
	gw_buffer ray_directory;

	/* Leaves. A leaf holds at most two facets: planes with the mean of what lies in the leaf. They
	 * are numbered in the order of leaves, a second one after the first one of its leaf; every leaf
	 * has a number for its first facet, which is all zero where it holds none. Before them comes
	 * the empty facet, which is all zero, too, and counts as the second one of a leaf that holds
	 * none, if there is such a leaf, so that it has no fragments. */
	/* R32_UINT, facet_count: bits 0-30 the leaf, bit 31 whether it is that one's second */
	gw_buffer facet_leaf;
	/* R32G32B32A32_SFLOAT, 2 * leaf_count: by RoI intersection volume (Salm 4.3.4): [2i] =
	 * albedo rgb times opacity, opacity (may exceed 1, see there); [2i+1] = NDF xyz times
	 * opacity, 0; none of octrees without regions */
	gw_buffer leaf_geometry;
	/* R32G32B32A32_SFLOAT, facet_count, as the next three: unit normal n, offset c; the plane is
	 * n . (g - cell centre) = c, in leaf cells */
	gw_buffer facet_plane;
	/* R32G32B32A32_SFLOAT: centroid in grid coordinates, area in leaf cells^2 */
	gw_buffer facet_centre;
	/* R32G32B32A32_SFLOAT: area-weighted mean albedo; w = 1 if mostly two-sided, or else
	 * GW_FACET_UNCLEAR if some of it may face either way, plus the mean transparency, which is
	 * below 1 */
	gw_buffer facet_albedo;
	/* R32G32B32A32_SFLOAT: area-weighted mean Le; w = 0. One texel when nothing emits */
	gw_buffer facet_emission;

	/* Fragments, sorted by leaf and then by surfel: who contributes to which leaf. */
	/* R32_UINT, leaf_count + 1: first fragment of each leaf */
	gw_buffer leaf_fragment;
	/* R32_UINT, fragment_count: bits 0-29 the surfel; bit 30: which facet it joined; bit 31: a
	 * RoI fragment (weight is an intersection volume, leaf cells^3; octrees with regions alone
	 * have some) rather than a disc fragment (weight is an area, leaf cells^2) */
	gw_buffer fragment_surfel;
	/* R32_SFLOAT, fragment_count */
	gw_buffer fragment_weight;

	/* Samples on the device, in surfel order (windowed by streaming passes). */
	/* R32G32B32A32_SFLOAT: grid coordinates g, RoI (leaf cells, <= 1) */
	gw_buffer surfel_position;
	/* R32G32B32A32_SFLOAT: unit normal; w = 1 if two-sided, GW_MARK_CREASED if all its cuts are at
	 * creases, GW_MARK_UNCLEAR if nobody knows which side is its front, GW_MARK_BACK if it is the
	 * back of such a one, which has no fragments */
	gw_buffer surfel_normal;
	/* R32G32B32A32_SFLOAT: radius and area of the disc, direction of the first clip (see
	 * gw_surfels; lengths in leaf cells) */
	gw_buffer surfel_disc;
	/* R32G32B32A32_SFLOAT: distance of the first clip; direction and distance of the second */
	gw_buffer surfel_clip;

	/* Large discs. Such a surfel contributes all of its area to the leaf of its centre, so that
	 * there is a facet that stands for it; where its surface is, only this tree knows. */
	/* R32G32B32A32_UINT: see disc_tree.h; coordinates of the grid, numbers of facets. One texel, 0,
	 * when there are none */
	gw_buffer disc_tree;

	bool backs; /* some surfels are backs */

	/* Its empty space: NULL until somebody asks (compartments.h). Of an octree that is much deeper
	 * than its points ask for a coarser one of the same surfels has them, of which hardly any
	 * buffers are kept then. */
	struct gw_compartments *compartments;
	struct gw_octree *coarser;
	uint32_t *facet_compartment; /* facet_count: what they face; NULL where there is but one */
} gw_octree;

/* The leaf of a facet, of which that is in facet_leaf; and whether it is the second one there. */
static inline size_t gw_facet_leaf(uint32_t word)
{
	return word & GW_FACET_LEAF;
}

static inline bool gw_facet_is_second(uint32_t word)
{
	return (word & GW_FACET_SECOND) != 0;
}

/* Has a fragment joined such a facet of its leaf, as one of its discs? */
static inline bool gw_facet_holds(uint32_t word, uint32_t fragment)
{
	return (fragment & GW_FRAGMENT_ROI) == 0 &&
		   ((fragment & GW_FRAGMENT_FACET) != 0) == gw_facet_is_second(word);
}

/* The number of the first facet of a leaf, of which tile holds what leaf_tile has of its tile. */
static inline uint32_t gw_facet_first(const uint32_t tile[2], uint32_t octant)
{
	uint32_t below = (1u << octant) - 1u;
	return tile[0] + (uint32_t)__builtin_popcount(tile[1] & (below | below << 16));
}

/* The opacity of a facet, of which w is that of its facet_albedo. */
static inline float gw_facet_opacity(float w)
{
	return 1.0f - (w - floorf(w));
}

/* Whether a surfel's disc is too large for leaves and in the tree of large discs, where it comes
 * after those of earlier surfels; of what is far off all the rest none is. */
bool gw_octree_disc_is_large(const gw_octree *octree, const gw_surfels *surfels, size_t surfel);

/* What makes its discs of surfels, in coordinates of the grid. */
gw_disc_shape gw_octree_disc_shape(const gw_octree *octree);

/* The depth that GW_DEPTH_AUTO gives when memory suffices. */
uint32_t gw_octree_auto_depth(const gw_surfels *surfels);

/* What GW_LEAF_SPACING_AUTO stands for; any other width is asked for. */
float gw_octree_leaf_spacing(float asked, size_t surfels, bool regions);

/* An octree to be built. */
typedef struct gw_octree_task {
	const gw_surfels *surfels;
	/* 1..GW_DEPTH_MAX: leaves are as small as the depth allows; GW_DEPTH_AUTO: they are as wide as
	 * leaf_spacing says, or as much wider as memory and the device's limits ask for, and then the
	 * octree says so */
	uint32_t depth;
	/* of GW_DEPTH_AUTO: the width, in surfels->spacing; or GW_LEAF_SPACING_AUTO */
	float leaf_spacing;
	/* regions of influence make leaves, too, and these have their geometry: for voxels and cones.
	 * Rays meet discs alone, and do without these leaves, which are a sixth of all in a smooth
	 * scene and two fifths on rough rock; and without border tiles */
	bool regions;
	/* of gw_octree_build_kept: so many surfels stay where they are, the first ones. These, bounds
	 * and spacing must be the same in every build; or, in the first one, they may be all there are
	 */
	size_t still;
} gw_octree_task;

/*
 * Builds the octree of a cloud.
 *   octree  on success to be freed with gw_octree_destroy; zeroed on failure
 * Fails with GW_ERROR_MEMORY, with the bytes needed and a depth that would fit.
 */
gw_status gw_octree_build_task(gw_gpu *gpu, const gw_octree_task *task, gw_octree *octree,
							   gw_error *error);

/* The same with regions, of a depth, or by GW_LEAF_SPACING. */
gw_status gw_octree_build(gw_gpu *gpu, const gw_surfels *surfels, uint32_t depth, gw_octree *octree,
						  gw_error *error);
void gw_octree_destroy(gw_gpu *gpu, gw_octree *octree);

/* Whether facets have such numbers as the octree says: these are the words of its facet_leaf and
 * leaf_tile, of which each is within its bounds. */
bool gw_octree_numbers_fit(const gw_octree *octree, const uint32_t *facet_leaf,
						   const uint32_t *leaf_tile);

/* Drops tile_neighbour and leaf_tile_neighbour: with compartments found only cones need them. */
void gw_octree_drop_neighbours(gw_gpu *gpu, gw_octree *octree);

/* What octrees have in common whose first surfels are the same: fragments of these, and passes. */
typedef struct gw_octree_kept gw_octree_kept;

/*
 * Only the places and normals of surfels, in the coordinates of the grid that an octree of the same
 * task would have: for light that nothing hides. Depth and all counts are 0. Where memory would
 * have made the octree coarser, the grid is not.
 *   octree   as of gw_octree_build_task
 */
gw_status gw_octree_without_tree(gw_gpu *gpu, const gw_octree_task *task, gw_octree *octree,
								 gw_error *error);

/*
 * Builds the same octree as gw_octree_build_task, to the last bit, quicker when it is built again
 * with surfels of which only those at and after task->still have moved (Salm 4.5).
 *   kept    *kept is NULL in the first call, which chooses depth and width of the leaves; to be
 *           destroyed with gw_octree_kept_destroy
 */
gw_status gw_octree_build_kept(gw_gpu *gpu, const gw_octree_task *task, gw_octree_kept **kept,
							   gw_octree *octree, gw_error *error);
void gw_octree_kept_destroy(gw_gpu *gpu, gw_octree_kept **kept); /* sets *kept to NULL */

#endif
