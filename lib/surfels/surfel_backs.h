/* surfel_backs.h - the other side of surfaces of which nobody knows which side is the front. */
#ifndef SURFEL_BACKS_H
#define SURFEL_BACKS_H

#include "cloud/surfels.h"

/* Appends to the surfels those of the backs: of each whose two_sided is GW_SIDE_UNCLEAR one at the
 * same place that faces the other way, in the same order, with two_sided GW_SIDE_BACK. No point has
 * a back as its surfel. On failure the surfels are as they were. */
gw_status gw_surfel_backs_add(gw_surfels *surfels, gw_error *error);

/* The back of each surfel, or UINT32_MAX.
 *   back   receives surfels->count numbers for free(), or NULL where nothing has a back */
gw_status gw_surfel_backs_find(const gw_surfels *surfels, uint32_t **back, gw_error *error);

#endif
