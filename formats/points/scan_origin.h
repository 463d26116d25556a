/*
 * scan_origin.h - whether a scanner stood at the origin, told by the rows and columns of its grid.
 */
#ifndef SCAN_ORIGIN_H
#define SCAN_ORIGIN_H

#include "points/scan.h"

/* Points of a scan that are a grid: columns of the table with their row and column. */
typedef struct scan_grid {
	const scan_column *row, *column;
	size_t first, count; /* points */
} scan_grid;

/*
 * Whether all points of a row have the same elevation, seen from the origin, and all of a column
 * the same azimuth; or the other way round. Points that somebody moved elsewhere do not look so.
 * False also when memory is short or the grid says nothing: fewer than 8 rows or columns.
 */
bool scan_grid_faces_origin(const scan *scan, const scan_grid *grid);

#endif
