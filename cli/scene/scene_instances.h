/*
 * scene_instances.h - which inputs of a scene are one object in several places, whose surface is
 * made once.
 */
#ifndef SCENE_INSTANCES_H
#define SCENE_INSTANCES_H

#include "scene/loaded_scene.h"

/*
 * Lists the clouds that stand in several places by matrices that turn, mirror, move and scale
 * evenly. Sampled meshes have other points in each place; where coordinates are brought to metres,
 * and where something moves, no cloud is listed.
 *   scene      read and joined
 *   instance   receives *count of them, in order, for free(); NULL when there are none
 * Fails with GW_ERROR_MEMORY.
 */
gw_status scene_instances_list(const settings *settings, const loaded_scene *scene,
							   gw_object_instance **instance, size_t *count, gw_error *error);

#endif
