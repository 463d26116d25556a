/*
 * albedo_solve.h - the albedo behind photographed colours: the light in which they were taken is
 * baked and divided out, and baked again with that albedo, until nothing changes any more.
 */
#ifndef ALBEDO_SOLVE_H
#define ALBEDO_SOLVE_H

#include "scene/loaded_scene.h"

/* Albedo stays within these bounds, which natural surfaces do. */
#define ALBEDO_SOLVE_LEAST 0.01f
#define ALBEDO_SOLVE_MOST 0.95f

/* What was found, for messages. */
typedef struct albedo_facts {
	size_t dark;    /* points that no light of the set-up reaches: the albedo is that around them */
	size_t clipped; /* points beyond the bounds */
	double scale;   /* colour, 0 to 1 and linear, of radiance 1 in the photographs */
	double change;  /* mean relative change of the albedo in the last round */
	int rounds;
} albedo_facts;

/*
 * Replaces scene->points.albedo, which holds the photographed colours, linear, by the albedo.
 *   scene      its points' albedo, 0 to 1
 *   settings   how to bake; capture_scale is the colour of radiance 1, 0 finds it: the brightest
 *              surfaces then have an albedo of 0.8
 *   light      light_count, the set-up in which the photographs were taken
 *   own_lamps  light i is the flash of scanner i, and lit only what that one saw
 * GW_ERROR_DATA when the lights reach no point; or as gw_bake.
 */
gw_status albedo_solve(loaded_scene *scene, const settings *settings, const gw_light *light,
					   size_t light_count, bool own_lamps, albedo_facts *facts, gw_error *error);

/*
 * The chroma of the photographs and the level of the laser.
 * GW_ERROR_DATA when the intensity is zero almost everywhere.
 */
gw_status albedo_of_laser(loaded_scene *scene, const settings *settings, albedo_facts *facts,
						  gw_error *error);

#endif
