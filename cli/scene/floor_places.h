/*
 * floor_places.h - where in a cloud somebody can stand, or put a lamp: on floor that is free to
 * head height.
 */
#ifndef FLOOR_PLACES_H
#define FLOOR_PLACES_H

#include "glowworm.h"

#include <stddef.h>

/* Free height above the floor, and free floor to all sides of a place, metres. */
#define FLOOR_HEAD 1.8
#define FLOOR_REACH 0.3

#define FLOOR_PLACES_MAX 16

/*
 * Finds places on the floor, the most open first, then others at least two metres of way from each
 * that was found before, so that each room has its own; further apart where they would be more than
 * FLOOR_PLACES_MAX. They do not depend on the order of the points.
 *
 * Looks at cubes of a decimetre, or so much larger that hardly any holds a single point.
 * Floor are such with two points or more and nothing above them to head height; with nothing above
 * them at all, only where nothing is further below: else it is the outside of a ceiling.
 *
 *   position   3 * count, metres; values that are not finite are left out
 *   up         as gw_camera_up has it
 *   place      receives 3 * *found of them, metres: on the floor
 *   found      receives how many, 0 when there is no such floor
 * GW_ERROR_MEMORY.
 */
gw_status floor_places_find(const double *position, size_t count, char up,
							double place[3 * FLOOR_PLACES_MAX], size_t *found, gw_error *error);

#endif
