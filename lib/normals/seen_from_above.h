/*
 * seen_from_above.h - whether a cloud is one of ground that was seen from above alone, as airborne
 * scans and models of terrain are. Internal to lib/.
 *
 * Such a cloud is wide, its points lie decimetres apart or more, and over most of its plan there is
 * one layer of surface: trees and roofs' rims have another one below them, but no ceiling covers
 * its floors. Whoever saw it was above, so that all of it has its front up.
 */
#ifndef SEEN_FROM_ABOVE_H
#define SEEN_FROM_ABOVE_H

#include "cloud/surfels.h"

#include <stdbool.h>

/*
 * Whether surfels are wide, far apart and of one layer.
 *   area      a surfel's, m^2, rough
 *   is_wide   receives the answer
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_is_one_wide_layer(const gw_surfels *surfels, const float *area, bool *is_wide,
							   gw_error *error);

#endif
