/*
 * record_places.h - where records go: dart throwing over the lobes, on the host.
 */
#ifndef RECORD_PLACES_H
#define RECORD_PLACES_H

#include "glowworm.h"

/*
 * Chooses lobes for records, see gw_records_place.
 *   centre, plane   4 * slots floats, as gw_octree.lobe_centre and lobe_plane; slots of area 0 are
 *                   skipped
 *   spacing         leaf cells; 0 chooses every lobe
 *   radius          of influence, leaf cells: how far off a lobe's plane counts as another surface
 *   chosen          receives the slots in ascending order, allocated; freed by the caller
 */
gw_status gw_place_records(const float *centre, const float *plane, size_t slots, float spacing,
						   float radius, uint64_t seed, uint32_t **chosen, size_t *count,
						   gw_error *error);

#endif
