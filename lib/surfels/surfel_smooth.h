/* surfel_smooth.h - the surface behind noisy points. Internal to lib/. */
#ifndef SURFEL_SMOOTH_H
#define SURFEL_SMOOTH_H

#include "cloud/neighbours.h"

/*
 * Finds the noise of the points. Where it is significant, replaces position and normal by those of
 * the surface that the points scatter around, keeps the normals from before, without their noise,
 * in shading_normal, and fills shading_normal_off and noise. Clean clouds stay as they are; in
 * those partly clean, what lies in clean parts, and points that fill space.
 *   options    GW_EFFECT_NOISE may be forced, or forbidden: then nothing is looked at
 *   search     of the surfels as they are; of no more use when they change
 *   filled     count, as gw_filled_space_find finds it
 *   smoothed   receives whether anything was replaced
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_surfels_smooth(const gw_surfels_options *options, gw_neighbours *search,
							const uint8_t *filled, gw_surfels *surfels, bool *smoothed,
							gw_error *error);

#endif
