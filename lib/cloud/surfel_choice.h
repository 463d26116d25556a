/* surfel_choice.h - leaves the surfels that are asked for. Internal to lib/. */
#ifndef SURFEL_CHOICE_H
#define SURFEL_CHOICE_H

#include "cloud/surfels.h"

/*
 * Asks options->choose and takes all other surfels off the arrays that gw_frame_make filled. Bounds
 * and origin stay. All have to have normals, which count as given from then on.
 * Fails as options->choose does, and with GW_ERROR_MEMORY.
 */
gw_status gw_surfels_choose(const gw_surfels_options *options, gw_surfels *surfels,
							gw_error *error);

#endif
