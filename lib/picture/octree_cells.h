/*
 * octree_cells.h - the octree's cells on the host, level by level, for those who want to see them
 * (Salm, figure 5.1).
 */
#ifndef OCTREE_CELLS_H
#define OCTREE_CELLS_H

#include "picture/render_octree.h"

/* Cells of one size, in Morton order. */
typedef struct gw_cells {
	size_t count;
	uint64_t *key;   /* count, Morton keys */
	float size;      /* metres */
	float corner[3]; /* of cell 0, 0, 0; metres in the surfels' local frame */
} gw_cells;

/*
 * The cells of a level that hold surface.
 *   level   1 to the octree's depth, whose cells are the leaves
 *   cells   on success freed with gw_cells_clear; zeroed on failure
 * Fails with GW_ERROR_USAGE when there is no such level, GW_ERROR_MEMORY.
 */
gw_status gw_cells_list(gw_render_octree *octree, uint32_t level, gw_cells *cells, gw_error *error);

/* The border tiles of a level, each as the cell that its eight nodes share, of the level above:
 * tiles without surface, of which filtering across bricks takes zeros. As gw_cells_list. */
gw_status gw_cells_list_borders(gw_render_octree *octree, uint32_t level, gw_cells *cells,
								gw_error *error);
void gw_cells_clear(gw_cells *cells);

/* The place of a key, or SIZE_MAX. */
size_t gw_cells_find(const gw_cells *cells, uint64_t key);

/*
 * What each cell shows to one side. Needs bricks.
 *   cells   of gw_cells_list
 *   level   theirs
 *   side    0..5: +x -x +y -y +z -z
 *   shown   4 * cells->count: mean radiance, and area in faces of the cell (its opacity, which may
 *           exceed 1)
 */
gw_status gw_cells_show(gw_render_octree *octree, const gw_cells *cells, uint32_t level,
						uint32_t side, float *shown, gw_error *error);

#endif
