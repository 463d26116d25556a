/*
 * scene_probes.h - probes in a scene that need not be lit: places in its free space, and maps of
 * the surface that is seen from there.
 */
#ifndef SCENE_PROBES_H
#define SCENE_PROBES_H

#include "bake/scene.h"

/*
 * Finds places for probes and traces what is seen from there.
 *   in_grid   they are for records: how much of the surface they see is not looked at, nor how far
 *             they are from it, and where there is no free space within the bounds they stand
 *             outside
 *   placed    on success to be cleared by the caller; empty on failure
 */
gw_status gw_scene_place_probes(gw_scene *scene, const gw_probes_options *options, bool in_grid,
								gw_placed_probes *placed, gw_error *error);

/* Describes them as probes with room for their maps, in metres or grid coordinates.
 *   probes   empty; receives them, in part on failure */
gw_status gw_scene_describe_probes(const gw_scene *scene, const gw_placed_probes *placed,
								   bool in_grid, gw_probes *probes, gw_error *error);

/* A length of the scene in the metres that were given. */
double gw_scene_metres(const gw_scene *scene, double length);

/* Places probes for the rays of records, into scene->maps: as many as see what any place sees, with
 * maps of the scene's probe_size. Where they stand already, nothing is done; on failure there are
 * none. */
gw_status gw_scene_make_maps(gw_scene *scene, gw_error *error);

#endif
