/*
 * range_grid.h - one range image as a grid, and planes of its points. Internal to lib/.
 */
#ifndef RANGE_GRID_H
#define RANGE_GRID_H

#include "glowworm_picture.h"

#define GW_RANGE_BINS 128 /* of the range, four an octave from 2^-12 m on */
#define GW_NO_POINT UINT32_MAX

/* One image, as a grid. */
typedef struct gw_range_grid {
	const gw_points *points;
	const gw_range_image *image;
	uint32_t *point;            /* owned; columns * rows: which point a cell has, or GW_NO_POINT */
	double step;                /* radians between neighbouring cells, the median; 0: uneven */
	float noise[GW_RANGE_BINS]; /* standard deviation of the range, metres */
} gw_range_grid;

/* The plane that a point is on: those v, from the scanner, of which a . v is 1. */
typedef struct gw_range_plane {
	float a[3];
	uint8_t half;    /* cells from the middle of the window to its sides; 0: no plane */
	int8_t aside[2]; /* rows and columns, in halves, from the point to that middle: -1, 0 or 1 */
} gw_range_plane;

/* From the scanner to the point of a cell; false when it has none, or lies at the scanner. */
bool gw_range_way(const gw_range_grid *grid, size_t cell, double way[3]);

/* The product of a plane's normal and a vector. */
static inline double gw_range_plane_dot(const gw_range_plane *plane, const double v[3])
{
	return (double)plane->a[0] * v[0] + (double)plane->a[1] * v[1] + (double)plane->a[2] * v[2];
}

/* Sorts an image's points into its cells, unless it is too small or too empty to tell anything:
 * then point is NULL. False when memory is short. To be closed in any case. */
bool gw_range_grid_open(const gw_points *points, const gw_range_image *image, gw_range_grid *grid);
void gw_range_grid_close(gw_range_grid *grid);

#endif
