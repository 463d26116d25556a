/*
 * lamp_reach.h - which lamps can light anything at all, told without rays: a spot that shines past
 * every point is not called for.
 */
#ifndef LAMP_REACH_H
#define LAMP_REACH_H

#include "cloud/surfels.h"

/*
 * Whether any surfel lies where the light shines, whatever hides it; false only where the light
 * would add exactly 0 to all of them. The answer is the same for any order of the points.
 *   light    point, spot or sun; one that is black reaches nothing
 *   threads  of the CPU; 0 means one a core
 */
bool gw_lamp_reaches(const gw_light *light, const gw_surfels *surfels, uint32_t threads);

#endif
