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
	size_t ends;    /* points with values at an end of the photographs' scale, white or black */
	char how[120];  /* what was done to the laser's intensity, a phrase, or "" */
	double scale;   /* colour, 0 to 1 and linear, of radiance 1 in the photographs */
	double change;  /* mean relative change of the albedo in the last round */
	double remainder; /* by what share of itself light that nobody named changed it, the mean */
	int rounds;
} albedo_facts;

/* In what light the photographs were taken. */
typedef struct albedo_setup {
	const gw_light *light; /* light_count */
	size_t light_count;
	bool flash; /* light i is the flash of scanner i, and lit what that one saw, all of it */
} albedo_setup;

/*
 * Replaces scene->points.albedo, which holds the photographed colours, linear, by the albedo.
 *   scene      its points' albedo, 0 to 1
 *   settings   how to bake; capture_scale is the colour of radiance 1, 0 finds it: the brightest
 *              surfaces then have an albedo of 0.8
 * GW_ERROR_DATA when the lights reach no point; or as gw_bake.
 */
gw_status albedo_solve(loaded_scene *scene, const settings *settings, const albedo_setup *setup,
					   albedo_facts *facts, gw_error *error);

/*
 * The chroma of the photographs and the level of the laser.
 * GW_ERROR_DATA when the intensity is zero almost everywhere.
 */
gw_status albedo_of_laser(loaded_scene *scene, const settings *settings, albedo_facts *facts,
						  gw_error *error);

#endif
