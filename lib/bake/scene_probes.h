/*
 * scene_probes.h - probes in a scene that need not be lit: places in its free space, and maps of
 * the surface that is seen from there.
 */
#ifndef SCENE_PROBES_H
#define SCENE_PROBES_H

#include "bake/scene.h"
#include "glowworm_probes.h"
#include "light/gather_probes.h"
#include "light/probe_places.h"

/* All that lasts as long as probes are placed. */
typedef struct gw_probe_placing {
	gw_scene *scene;
	const gw_probes_options *options;
	gw_neighbours *search;
	gw_free_ball *ball;
	size_t ball_count;
	gw_sight_places chosen_by, looked_at;
	gw_free_ball_task room;
	gw_probe_places places;
	bool in_grid; /* they are wanted in grid coordinates, to light records by */
} gw_probe_placing;

/* Finds places for probes and describes these; how much of the surface they see is looked at where
 * they are not for records.
 *   placing   its scene, options and in_grid given; to be ended by the caller, on failure too
 *   probes    empty; receives probes with room for their maps, in part on failure */
gw_status gw_probe_placing_run(gw_probe_placing *placing, gw_probes *probes, gw_error *error);
void gw_probe_placing_end(gw_probe_placing *placing);

/* A length of the scene in the metres that were given. */
double gw_scene_metres(const gw_scene *scene, double length);

/* Places probes for the rays of records: as many as see what any place sees, with maps of the
 * scene's probe_size. Where there is no free space within the bounds they stand outside.
 *   maps   on success to be cleared by the caller; empty on failure */
gw_status gw_scene_probe_maps(gw_scene *scene, gw_probe_maps *maps, gw_error *error);

#endif
