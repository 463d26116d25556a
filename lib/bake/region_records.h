/*
 * region_records.h - records of a part of a scene, and of what its light depends on.
 */
#ifndef REGION_RECORDS_H
#define REGION_RECORDS_H

#include "bake/scene.h"

/*
 * Places the records of the region and those that they depend on, finds what they see, and which of
 * them light each facet and each surfel: in place of the steps of gw_scene_place_records. Surfels
 * that are needed but not asked for get what their facets get.
 */
gw_status gw_region_place_records(gw_scene *scene, gw_error *error);

#endif
