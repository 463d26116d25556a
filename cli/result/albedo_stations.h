/*
 * albedo_stations.h - several scans of one place, each photographed at an exposure of its own:
 * their levels are made the same where they overlap. A scan is what one scanner saw from one place,
 * be it one of many in a file, or, where nobody says who saw a point, an input.
 */
#ifndef ALBEDO_STATIONS_H
#define ALBEDO_STATIONS_H

#include "scene/loaded_scene.h"

/*
 * Multiplies the values of each scan but that of the first point by one factor a channel, so that
 * in places with points of two scans both have the same level, as well as can be (least squares of
 * logarithms). Scans that overlap with no other keep their level.
 *   ends    count: points with any bit are left out, as they are clipped (albedo_clipped.h)
 *   level   3 * count, in the order of the scene's points; 0 where nothing is known
 * GW_ERROR_MEMORY.
 */
gw_status albedo_stations_level(const loaded_scene *scene, const uint8_t *ends, float *level,
								gw_error *error);

/* Whether the scene has more scanners than a tripod is put up for, more than 64: they are taken for
 * the way of one that was carried, whose camera kept its exposure. */
bool albedo_stations_are_a_way(const loaded_scene *scene);

#endif
