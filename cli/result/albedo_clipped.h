/*
 * albedo_clipped.h - photographed values at an end of their scale: of white it is only known that
 * the albedo is at least so much, of black that it is at most so much.
 */
#ifndef ALBEDO_CLIPPED_H
#define ALBEDO_CLIPPED_H

#include "scene/loaded_scene.h"

/* Which values of a point are at an end: bits 0 to 2 white, 3 to 5 black. */
#define ALBEDO_WHITE(channel) (1u << (channel))
#define ALBEDO_BLACK(channel) (8u << (channel))

/*
 * Finds them.
 *   photo   3 * count, 0 to 1 and linear
 *   ends    count, receives the bits
 * Returns how many points have any.
 */
size_t albedo_clipped_find(const float *photo, size_t count, uint8_t *ends);

/*
 * Gives such values what the points around have that were not clipped: their mean level, or where
 * other channels of the point are known, their chroma and its level. What is known to be the least
 * or the most stays so.
 *   known   count: whether the point's light is known
 *   level   3 * count: of values at an end, the bound on input, and what is taken for them on
 * output GW_ERROR_MEMORY.
 */
gw_status albedo_clipped_fill(const gw_points *points, const uint8_t *ends, const uint8_t *known,
							  float *level, gw_error *error);

#endif
