/*
 * shadow_error.h - what the edges of shadows are off, from the light that lamps bring to the
 * points.
 *
 * Lamps are shadowed at every point, but what casts the shadow ends somewhere between its last
 * points, and so do its shadow's edges. Points beside an edge are then lit that should not be, or
 * the other way round: n l |d| of them along an edge of length l, with n points a square metre and
 * an edge that is off by d. How long the edges are shows where neighbouring points on the same
 * surface differ: of a point's neighbours within r, the share on the other side of an edge, summed
 * over all points around, is n l r 4 / (3 pi).
 *
 * Edges are taken to be off by what free edges of surface among random points are, or, where what
 * hides the light ends at a crease, by the little that creases are: their place is known from both
 * sides; and by nothing there where the lamp has an extent. Where a lamp is nearer to what casts
 * the shadow than to the shadow, the shadow's edge is off by as many times more.
 */
#ifndef SHADOW_ERROR_H
#define SHADOW_ERROR_H

#include "cloud/surfels.h"

/* Mean distance of an edge from its true place, in spacings of the points: measured on the sides of
 * square openings among random points. */
#define GW_EDGE_OFFSET 0.24

/* The same of a crease: measured on blocks that stand in the sun. */
#define GW_CREASE_OFFSET 0.025

/*
 * Expected mean over the counted surfels of the squared error of luminance that misplaced edges
 * bring.
 *   direct       4 a surfel, irradiance from lamps, and luminance of what of it is hidden: below 0
 *                by surface that ends at a crease, else as many times as the shadow's edge is
 *                further off than what casts it
 *   counts       one a surfel: whether its error counts
 *   threads      as for gw_parallel_for
 *   mean_square  receives it, (W/(sr m^2))^2; 0 when none counts
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_shadow_error(const gw_surfels *surfels, const float *direct, const bool *counts,
						  uint32_t threads, double *mean_square, gw_error *error);

#endif
