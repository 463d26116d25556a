/*
 * scaled_scene.h - scenes whose lengths or lights float32 could not hold, baked in other units.
 *
 * Areas of a cloud of 1e-20 m are 1e-40 m^2 and the irradiance near a lamp of 1e38 W/sr more than
 * there are numbers for. Such a scene is baked with lengths and light multiplied by powers of two,
 * which rounds nothing, and its result is brought back. A lamp that is very far beside the size of
 * such a cloud would be infinitely bright in its units: it is brought nearer, and dimmed to give
 * the same light. Ordinary scenes are left as they are.
 */
#ifndef SCALED_SCENE_H
#define SCALED_SCENE_H

#include "glowworm_picture.h"

typedef struct gw_scaled_scene {
	int length;                 /* lengths are multiplied by 2^length, */
	int light;                  /* and radiance and irradiance by 2^light */
	double middle[3];           /* of the points, as given, */
	int extent;                 /* and the power of two that their extent begins at: of scenes whose
								   length is not 0 */
	gw_scene_description scene; /* in these units; as it was given when both are 0 */
	gw_points points;
	gw_light *lights; /* NULL when both are 0 */
	gw_bake_options options;
	double *position, *scanner; /* of points, where they are copies */
	double *visible;            /* the same of points of which some are invisible: without these */
	float *emission, *own_area;
	gw_object_instance *instance;
	gw_region region; /* of options, where its camera is a copy: */
	gw_camera camera;
} gw_scaled_scene;

/*
 * Chooses the units, and copies what changes with them. Points that are invisible lose their place,
 * as if it was not finite.
 *   reach    metres by which something of it moves, 0 when nothing does
 *   scaled   to be freed with gw_scaled_scene_clear, also on failure; refers to what was given
 * Fails with GW_ERROR_MEMORY, or GW_ERROR_DATA where an opacity is none, or a light is more in
 * these units than a float32 holds.
 */
gw_status gw_scaled_scene_make(const gw_scene_description *scene, const gw_bake_options *options,
							   double reach, gw_scaled_scene *scaled, gw_error *error);

/* Brings a result back into the units that were given. Fails with GW_ERROR_DATA where its light is
 * more than a float32 holds. */
gw_status gw_scaled_scene_undo(const gw_scaled_scene *scaled, gw_bake_result *result,
							   gw_error *error);
/* The same for radiance alone: 3 * count. */
gw_status gw_scaled_scene_undo_radiance(const gw_scaled_scene *scaled, float *radiance,
										size_t count, gw_error *error);

/*
 * Copies other lights into these units.
 *   copy   on success the lights, for free(); NULL on failure
 * Fails with GW_ERROR_MEMORY, or GW_ERROR_DATA where one is more than a float32 holds.
 */
gw_status gw_scaled_lights(const gw_scaled_scene *scaled, const gw_light *lights, size_t count,
						   gw_light **copy, gw_error *error);

/* A copy of 3 * count emissions in these units, for free(); NULL when there is no memory. */
float *gw_scaled_emission(const gw_scaled_scene *scaled, const float *emission, size_t count);

/* Keeps the units alone, and refers to nothing any more. */
void gw_scaled_scene_let_go(gw_scaled_scene *scaled);
void gw_scaled_scene_clear(gw_scaled_scene *scaled);

#endif
