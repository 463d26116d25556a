/*
 * picture_holes.h - where a picture shows nothing amid the points: looked at, that is as dark as
 * shadow, and is none.
 */
#ifndef PICTURE_HOLES_H
#define PICTURE_HOLES_H

#include "glowworm_picture.h"

#include <stddef.h>

/*
 * How much of a picture lies within its points and shows none of them: pixels that nothing covers,
 * and from which no way through such pixels, side by side, leads out of the picture.
 *   g      not empty
 *   share  receives their number over that of these and all that something covers, 0..1
 * Fails with GW_ERROR_MEMORY.
 */
gw_status picture_holes_find(const gw_gbuffer *g, double *share, gw_error *error);

#endif
