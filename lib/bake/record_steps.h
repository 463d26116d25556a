/*
 * record_steps.h - the records of a scene: placed, what they see traced, which of them light what.
 */
#ifndef RECORD_STEPS_H
#define RECORD_STEPS_H

#include "bake/scene.h"

/*
 * Finds the compartments of the octree, unless they are known, so that each facet has the area and
 * the emission of its own compartment alone (octree/compartment_facets.c). Records are placed by
 * these areas: only then do they stand at the same places whatever came before, such as a lamp's
 * shadows, a forecast or another lighting.
 */
gw_status gw_scene_part_facets(gw_scene *scene, gw_error *error);

/* Places the records, finds what they see, and which of them light each facet and each surfel. */
gw_status gw_scene_place_records(gw_scene *scene, gw_error *error);

/*
 * Adds records where scene->density says, finds what they see, and which records light each facet
 * and each surfel then. What others saw stays. On failure the records are to be dropped.
 */
gw_status gw_scene_add_records(gw_scene *scene, gw_error *error);

/* Makes the work space, and reports, where all of these came from a transport (transport.h). */
gw_status gw_scene_complete(gw_scene *scene, const gw_points *points, gw_error *error);

/* Places records only to find what they see, as scene.kept; they are dropped again. */
gw_status gw_scene_keep_hits(gw_scene *scene, gw_kept_hits *kept, gw_error *error);

#endif
