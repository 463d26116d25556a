/*
 * las_grid.h - the grid on which LAS keeps a coordinate: stored integer * scale + offset.
 */
#ifndef LAS_GRID_H
#define LAS_GRID_H

#include "points/scan.h"

/* Where no grid gives the coordinates back, their step may be up to this, in metres. */
#define LAS_GRID_COARSEST 1e-3

typedef struct las_grid {
	double scale, offset;
	double minimum, maximum; /* of the coordinates as they are stored */
	bool exact;              /* every coordinate comes back as it was, in its own type */
} las_grid;

/*
 * Finds a grid for a coordinate: the one that the scan's comments name when it is exact; else the
 * coarsest decimal one that is; else the finest that 32 bits reach. Of a scan whose `step` says how
 * coarse it may be, such a grid takes the place of finer ones.
 *   axis    0, 1 or 2: x, y or z
 *   name    of the file, for messages
 *   error   GW_ERROR_DATA when there is no such coordinate, when a value is no number or when the
 *           step would be over LAS_GRID_COARSEST
 */
gw_status las_grid_find(const scan *cloud, int axis, const char *name, las_grid *grid,
						gw_error *error);

/* The same for a scan that comes part by part. Zeros begin it. */
typedef struct las_grid_search {
	las_grid *candidate; /* owned; in the order in which they are wanted */
	size_t count;
	double minimum, maximum;
	uint64_t points; /* of this round */
	bool begun, decimal;
} las_grid_search;

/* Looks at a part. Fails like las_grid_find; GW_ERROR_MEMORY. */
gw_status las_grid_search_add(las_grid_search *search, const scan *part, int axis, const char *name,
							  gw_error *error);

/* To be called after all parts: sets *again when all have to be looked at once more. */
gw_status las_grid_search_go_on(las_grid_search *search, const char *name, bool *again,
								gw_error *error);

/* All of this for a scan that is the only part. */
gw_status las_grid_search_alone(las_grid_search *search, const scan *cloud, int axis,
								const char *name, gw_error *error);

/* The grid, when all is known. Fails like las_grid_find.
 *   step   as scan.step
 *   axis   of the grid; for messages */
gw_status las_grid_search_take(const las_grid_search *search, double step, int axis,
							   const char *name, las_grid *grid, gw_error *error);
void las_grid_search_clear(las_grid_search *search);

/* The integer that stands for a coordinate. */
int32_t las_grid_place(const las_grid *grid, double value);

#endif
