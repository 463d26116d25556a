/*
 * range_steps.h - the steps from a range image to what it tells, see range_image.h:
 *
 *         range_grid.c   cells, checks
 *         range_origin.c whether rays begin at the scanner, or else where
 *         range_noise.c  noise of the ranges, by range
 *         range_plane.c  windows and their planes
 *         range_blend.c  one surface from these
 *         range_mixed.c  what is no surface
 *         range_thin.c   what is thin, and how much it covers
 *         range_image.c  what comes out
 */
#ifndef RANGE_STEPS_H
#define RANGE_STEPS_H

#include "cloud/range_grid.h"

/* Do all rays begin at the scanner? */
bool gw_range_rays_meet(const gw_range_grid *grid);

/* A bin of a range, metres. */
uint32_t gw_range_bin(double range);

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
