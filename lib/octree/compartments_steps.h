/*
 * compartments_steps.h - what the steps that find compartments share.
 */
#ifndef COMPARTMENTS_STEPS_H
#define COMPARTMENTS_STEPS_H

#include "octree/compartments.h"

#include <math.h>

/* Of a cell that surface passes through, in place of a tile. */
#define GW_WALL 0xffffffffu

/* A cell of any size. */
typedef struct gw_compartment_cell {
	uint32_t number;
	uint32_t tile; /* of its children, plus one; 0: it is empty; or GW_WALL */
	uint32_t level;
} gw_compartment_cell;

/* Cells are the nodes of all tiles, in their order, then the leaves of all leaf tiles. */
struct gw_compartments {
	uint32_t depth;
	uint32_t cells;  /* of tiles and leaf tiles; the space around the octree is cell number that */
	uint32_t first;  /* of these: the first leaf */
	uint32_t *child; /* first: pointer (plus one) to the tile of a node's children, 0 where it holds
						nothing */
	uint8_t *leaves; /* a leaf tile: which of its leaves there are */
	uint8_t *node_neck; /* a tile: which of its nodes are part of a neck, where they are empty */
	uint8_t *leaf_neck; /* a leaf tile: likewise its leaves */
	uint32_t *label; /* cells + 1: a cell of the compartment, the same for all of it; in the end its
						number */
	uint32_t count;  /* of numbers */
	uint32_t *sides; /* 2 * surfels: what the front looks into, and the back; NULL where there are
						not several compartments */
};

/* The octree that has the compartments of one. */
const gw_octree *gw_compartments_octree(const gw_octree *octree);

/* A place in grid coordinates of an octree in those of that one. */
void gw_compartments_place(const gw_octree *octree, const float g[3], float place[3]);

/* A child of a cell. */
gw_compartment_cell gw_compartment_child(const gw_compartments *c, gw_compartment_cell of,
										 uint32_t octant);

/* Frees what is not needed once cells are joined. */
void gw_compartments_drop_necks(gw_compartments *c);

/* In which octant of its parent a cell lies that is so many levels above the one at a place. */
static inline uint32_t gw_octant_above(const int32_t at[3], uint32_t levels)
{
	return (uint32_t)(at[0] >> levels & 1) | (uint32_t)(at[1] >> levels & 1) << 1 |
		   (uint32_t)(at[2] >> levels & 1) << 2;
}

/* How far the middle of a cell, so many leaves wide, lies before a plane of a place and a normal in
 * leaf cells; reach receives from where on all of the cell does. */
static inline float gw_cell_before_plane(const float *place, const float *normal,
										 const int32_t at[3], uint32_t wide, float *reach)
{
	float half = 0.5f * (float)wide, off = 0.0f;
	for (int k = 0; k < 3; k++)
		off += normal[k] * ((2.0f * (float)at[k] + 1.0f) * half - place[k]);
	*reach = half * (fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]));
	return off;
}

/* What lies in the leaves of an octree: their tiles, the leaves of facets, the first fragment of
 * each leaf, the surfels of fragments. */
typedef struct gw_leaf_views {
	gw_view tile, leaf, first, fragment;
} gw_leaf_views;

/* views: to be closed by the caller, on failure too */
gw_status gw_leaf_views_open(gw_gpu *gpu, const gw_octree *octree, gw_leaf_views *views,
							 gw_error *error);
void gw_leaf_views_close(gw_leaf_views *views);

/* The first leaf of a tile that has some. */
static inline size_t gw_leaf_views_first(const gw_leaf_views *views, size_t tile)
{
	return gw_facet_leaf(
		((const uint32_t *)views->leaf.bytes)[((const uint32_t *)views->tile.bytes)[2 * tile]]);
}

/* Frees what is not needed where there is but one compartment. */
void gw_compartments_drop_cells(gw_compartments *c);

/* Which compartment a cell of leaves lies in; GW_COMPARTMENT_UNKNOWN for those of surface. */
uint32_t gw_compartment_of_cell(const gw_compartments *c, const int32_t cell[3]);

/* Does a cell of leaves lie in a wall of wider cells? */
bool gw_compartment_lies_in_wall(const gw_compartments *c, const int32_t cell[3]);

/* The leaf tile of a cell plus one, or 0. */
uint32_t gw_compartment_leaf_tile(const gw_compartments *c, const int32_t cell[3]);

/* Leaf cells: discs of this radius and more are of sparse surface. */
#define GW_SPARSE_RADIUS 2.0f

/* What makes walls of the empty cells that it passes: a disc, or the plane of a cell. */
typedef struct gw_wall_shape {
	const float *place, *normal; /* leaf cells */
	float radius;
	float tangent[3], bitangent[3];
	float cut[2][3]; /* direction and distance, leaf cells */
	uint32_t level;  /* of the cells that become walls; finer ones do where finer surface is */
	float reach;     /* beyond which none of these has its middle */
	uint32_t within; /* the level of the cell that it is within, or 0: it may be anywhere */
	int32_t at[3];   /* that cell */
} gw_wall_shape;

/* A disc, all of whose cells are about as wide as itself. */
gw_wall_shape gw_wall_shape_of_disc(const float *place, const float *normal, const float *size,
									const float *clip, uint32_t depth);

/* A cell of a level but above the leaves; where it holds something, what a plane passes of it. */
gw_wall_shape gw_wall_shape_of_plane(const float *place, const float *normal, uint32_t level,
									 const int32_t at[3]);

/* Gives a shape by its number; false: that one makes no walls. Called by several threads. */
typedef bool gw_wall_shape_of(const void *user, size_t number, gw_wall_shape *shape);

typedef struct gw_wall_shapes {
	size_t count;
	gw_wall_shape_of *of;
	const void *user;
	bool planes; /* not discs */
	bool necks;  /* they make necks, not walls */
} gw_wall_shapes;

/* Makes walls or necks as the shapes would in their order; c->first grows. The number of threads
 * changes nothing. */
gw_status gw_walls_make(gw_compartments *c, const gw_wall_shapes *shapes, uint32_t threads,
						gw_error *error);

/* Makes walls of the voids in surface that is sparser than leaves are wide; c->first grows. */
gw_status gw_compartments_close_sparse(gw_gpu *gpu, const gw_octree *octree,
									   const gw_surfels *surfels, uint32_t threads,
									   gw_compartments *c, gw_error *error);

/* Makes walls of the discs of sparse surface that is opaque; c->first grows. */
gw_status gw_compartments_wall_discs(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, uint32_t threads,
									 gw_compartments *c, gw_error *error);

/* Takes out of c->leaves those without a facet that lie before the planes of all their points. */
gw_status gw_compartments_open_near(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels,
									gw_compartments *c, gw_error *error);

/* Makes walls of the voids in surface. */
gw_status gw_compartments_close_voids(gw_gpu *gpu, const gw_octree *octree, gw_compartments *c,
									  gw_error *error);

/* The same of leaves, once walls of wider cells are made. */
gw_status gw_compartments_close_voids_again(gw_gpu *gpu, const gw_octree *octree,
											gw_compartments *c, gw_error *error);

/* Makes necks of what discs of sparse surface would cover that are cut; c->first grows. */
gw_status gw_compartments_mark_discs(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, uint32_t threads,
									 gw_compartments *c, gw_error *error);

/* Fills in c->node_neck and c->leaf_neck; c->first grows. */
gw_status gw_compartments_find_necks(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, uint32_t threads,
									 gw_compartments *c, gw_error *error);

/* Fills in c->label: the same number for all cells that are joined. */
gw_status gw_compartments_join(gw_gpu *gpu, const gw_octree *octree, size_t surfels,
							   uint32_t threads, gw_compartments *c, gw_error *error);

/* Fills in c->sides, or leaves it empty. */
gw_status gw_compartments_find_sides(gw_gpu *gpu, const gw_octree *octree, size_t surfels,
									 uint32_t threads, gw_compartments *c, gw_error *error);

/* Lets go of the buffers of an octree that is there for its compartments alone, but for those that
 * gw_compartments_of_places reads, if there are several. */
void gw_compartments_drop_rest(gw_gpu *gpu, gw_octree *octree);

/* Fills in octree->facet_compartment from what its surfels look into. There are several. */
gw_status gw_compartments_label_facets(gw_gpu *gpu, gw_octree *octree, gw_error *error);

/* Takes from each facet those of its surfels that look into another compartment. There are several,
 * and facets are labelled. */
gw_status gw_compartments_part_facets(gw_gpu *gpu, const gw_surfels *surfels, gw_octree *octree,
									  gw_error *error);

#endif
