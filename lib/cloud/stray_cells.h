/*
 * stray_cells.h - how many surfels lie where, by cells of a grid that hold a few each. Internal to
 * lib/.
 *
 * The grid is one of those that surfels are ordered by, so that the surfels of a cell, and the
 * cells of a larger cell, are next to each other.
 */
#ifndef STRAY_CELLS_H
#define STRAY_CELLS_H

#include "cloud/surfels.h"

typedef struct gw_stray_cells {
	size_t count;
	uint64_t *key; /* count, Morton keys, ascending */
	size_t *first; /* count + 1, the first surfel of each */
	int level;     /* 2^level cells along the longest side of the bounds */
	double width;  /* metres */
} gw_stray_cells;

/* Sorts surfels, all within their bounds, into the smallest cells that do not leave many with no
 * more than a few in the cells around; threads: 0 means one a processor. False when memory is
 * short; to be cleared in either case. */
bool gw_stray_cells_make(const gw_surfels *surfels, size_t few, uint32_t threads,
						 gw_stray_cells *cells);
void gw_stray_cells_clear(gw_stray_cells *cells);

/* Do no more than a few surfels lie in a cell and the 26 around it? */
bool gw_stray_cells_few_around(const gw_stray_cells *cells, size_t cell, size_t few);

/* What was found last: cells of one larger cell have it in common. */
typedef struct gw_stray_spacing {
	bool known;
	int coarser; /* levels */
	uint64_t key;
	double spacing;
} gw_stray_spacing;

/*
 * How far points are from each other there: the median, over the surfels in the larger cell that a
 * cell lies in and the 26 around that one, of the spacing that the number in their own cells means
 * on a surface.
 *   reach   metres; larger cells are at least as wide
 *   last    of the same cells, { 0 } at first
 */
double gw_stray_cells_spacing(const gw_stray_cells *cells, size_t cell, double reach,
							  gw_stray_spacing *last);

#endif
