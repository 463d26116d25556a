/*
 * surface_tree.h - the facets of an octree and its nodes as one hierarchy of pieces of surface
 * (Harada, section 4; the points of QSplat): each with its mean place, normal and albedo, its area,
 * a sphere around it, and a cone around the normals in it.
 *
 * Facets are the first elements, by their numbers; nodes follow, finer ones first, the
 * root last. A node's children follow each other.
 */
#ifndef SURFACE_TREE_H
#define SURFACE_TREE_H

#include "octree/octree.h"

/* The half-angle of a cone that holds all directions. */
#define GW_CONE_ALL 3.15f

typedef struct gw_surface_piece {
	float place[3];  /* mean, grid coordinates */
	float radius;    /* of a sphere about it that holds all of its surface, leaf cells */
	float normal[3]; /* mean, unit */
	float cone;      /* half-angle about it that holds all normals, radians; GW_CONE_ALL also where
						some surface has two sides or lets light through */
	float offset;    /* its plane: normal . g = offset */
	float area;      /* leaf cells^2; 0: there is nothing */
	float albedo[3];
	float opacity;         /* of a facet; below 1 as often as that a direction meets it */
	float low[3];          /* the corner of its cell, grid coordinates */
	float size;            /* the side of it, leaf cells; 0: a disc that reaches out of its cell */
	uint32_t first, count; /* children; none of a facet */
	bool two_sided;
	bool full; /* of a node: its surface fills the cell, and ends nowhere in it */
} gw_surface_piece;

typedef struct gw_surface_tree {
	gw_surface_piece *piece; /* count */
	uint32_t facets, count;
	uint32_t *level_first; /* level_count + 1: nodes of 2^(1 + level) leaf cells a side */
	uint32_t level_count;
} gw_surface_tree;

/* Makes it; on success to be cleared by the caller. */
gw_status gw_surface_tree_make(gw_gpu *gpu, const gw_octree *octree, gw_surface_tree *tree,
							   gw_error *error);
void gw_surface_tree_clear(gw_surface_tree *tree);

/*
 * Pulls radiance up: of each node the mean over its surface.
 *   radiance   4 * count; that of the facets is there
 */
void gw_surface_tree_pull(const gw_surface_tree *tree, uint32_t threads, float *radiance);

#endif
