/* surfel_making.h - the steps from points to surfels, in order. Internal to lib/. */
#ifndef SURFEL_MAKING_H
#define SURFEL_MAKING_H

#include "cloud/surfels.h"

/* gw_surfels_make that also gives the Euclidean gaps, for free(); gap may be NULL. */
gw_status gw_surfels_make_with_gaps(const gw_points *points, const gw_surfels_options *options,
									gw_surfels *surfels, float **gap, gw_error *error);

#endif
