/*
 * range_image.h - what rows and columns of a scan tell of its surface, before anything is made of
 * the points. Internal to lib/.
 *
 * Neighbours in the grid were seen in neighbouring directions, so that the surface between them is
 * known without a search: the range is smooth along it and jumps where it ends. On a plane
 * the inverse of the range is linear in the direction, whatever the grid; and noise and steps of
 * the range are along the rays. So each point gets the largest window of the grid, around it or
 * beside it, whose points are on one plane but for the noise. Its normal is that plane's, and where
 * there is noise its range is. What no plane holds, and lies between something nearer and something
 * further off that planes do hold, is a mixed pixel: the mean of two ranges, and no surface.
 *
 * Steps:  range_image.c  grids, checks, what comes out
 *         range_origin.c whether rays begin at the scanner, or else where
 *         range_noise.c  noise of the ranges, by range
 *         range_plane.c  windows and their planes
 *         range_blend.c  one surface from these
 *         range_mixed.c  what is no surface
 *         range_thin.c   what is thin, and how much it covers
 */
#ifndef RANGE_IMAGE_H
#define RANGE_IMAGE_H

#include "glowworm_picture.h"

/* Points with what their range images tell. */
typedef struct gw_ranged_points {
	gw_points points; /* those that came, with what follows in place, and without images */
	gw_surfels_options options; /* that came, but for what is to be done with normals: those of
								   images count as given */
	double *position;           /* NULL or owned: with less noise */
	float *normal;              /* NULL or owned: those that were missing */
	size_t normals;             /* how many of those */
	float *own_area;            /* NULL or owned: that of things as thin as a cell */
	uint8_t *stray;             /* NULL or owned: those that came, and those found */
} gw_ranged_points;

/*
 * Looks at all range images of some points. Those of which rays do not begin at their scanner, or
 * of which most cells are empty, tell nothing. The outcome is the same for any number of threads.
 *
 *   points   must live as long as the outcome, which is the same where there are no images
 *   ranged   on success to be cleared with gw_ranged_points_clear
 *
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_range_images_use(const gw_points *points, const gw_surfels_options *options,
							  gw_ranged_points *ranged, gw_error *error);
void gw_ranged_points_clear(gw_ranged_points *ranged);

/* ------------------------------------------------------------------------- what the steps share */

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

uint32_t gw_range_bin(double range);

/* The product of a plane's normal and a vector. */
static inline double gw_range_plane_dot(const gw_range_plane *plane, const double v[3])
{
	return (double)plane->a[0] * v[0] + (double)plane->a[1] * v[1] + (double)plane->a[2] * v[2];
}

/* Sorts an image's points into its cells, unless it is too small or too empty to tell anything:
 * then point is NULL. False when memory is short. To be closed in any case. */
bool gw_range_grid_open(const gw_points *points, const gw_range_image *image, gw_range_grid *grid);
void gw_range_grid_close(gw_range_grid *grid);

/* Do all rays begin at the scanner? */
bool gw_range_rays_meet(const gw_range_grid *grid);

/* Fills noise. False when memory is short. */
bool gw_range_noise_find(gw_range_grid *grid);

/* Fills a plane for each of image->count points, those from image->first on. False when memory is
 * short. */
bool gw_range_planes_find(const gw_range_grid *grid, uint32_t threads, gw_range_plane *plane);

/* What the point of a cell covers by itself, seen from the scanner, m^2, if it is a thing hardly
 * wider than a cell; else 0. */
float gw_range_own_area(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell);

/* Replaces each plane by the mean of those in whose windows its point lies, where that has the
 * point on it but for the noise. False when memory is short. */
bool gw_range_planes_blend(const gw_range_grid *grid, gw_range_plane *plane);

/* What kind of stray the point of a cell is by its planes: 0, or 1 + a gw_stray_kind. */
uint8_t gw_range_stray(const gw_range_grid *grid, const gw_range_plane *plane, size_t cell);

#endif
