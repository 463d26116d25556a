/*
 * emission_error.h - by how much all that emits may be too bright or too dark, from where it ends.
 *
 * What a point emits it emits from its cell, and cells do not end where a lamp does but between the
 * last points that emit and the first that do not. Among random points the area that this adds to a
 * lamp or takes from it varies by 0.2 spacings^3 for each spacing of the lamp's edge. How long
 * edges are shows where neighbouring points on the same surface emit differently, as in
 * shadow_error.h. Lamps whose edge is the end of a surface are not looked at, and all that emits is
 * taken as one: several lamps, each with light of its own to bring, are a little worse.
 */
#ifndef EMISSION_ERROR_H
#define EMISSION_ERROR_H

#include "cloud/surfels.h"

/* Variance of the area of the cells on one side of a straight line through random points, in units
 * of their spacing: measured on 200 squares each of 600 and 8100 points, 0.20 and 0.25. */
#define GW_CELL_VARIANCE 0.22

/*
 * Standard error of the power that the surfels emit, relative to it; 0 where nothing emits or
 * nothing ends on its surface.
 */
double gw_emission_error(const gw_surfels *surfels);

#endif
