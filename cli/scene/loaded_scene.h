/*
 * loaded_scene.h - the inputs of a scene, read and joined: what the files hold, and what the light
 * needs of it.
 */
#ifndef LOADED_SCENE_H
#define LOADED_SCENE_H

#include "meshes/mesh.h"
#include "panoramas/panorama.h"
#include "lamps/light_text.h"
#include "options/settings.h"
#include "scene/parted_cloud.h"
#include "units/coordinates.h"

/* What one input was. */
typedef struct loaded_input {
	const char *path; /* leads into the settings */
	const format *format;
	uint64_t points;   /* of the file */
	uint64_t left_out; /* rows of the file without a point */
	char albedo_source[240];
	bool albedo_missing; /* nothing says what the albedo is, so a constant stands in */
	bool albedo_told;    /* only their values tell what colours count to, or which are none */
	double albedo_mean;  /* of all points and colours, linear */
	bool lit;            /* glowworm wrote it */
	bool is_mesh;
	mesh mesh; /* what it was, without its shape; empty for a cloud */
} loaded_input;

typedef struct loaded_scene {
	scan cloud;          /* all points, in order; albedo_r albedo_g albedo_b are the colours that
							came in, or the albedo where none came, sRGB-encoded, uint8 */
	scan_points points;  /* the same points for the bake */
	loaded_input *input; /* owned; input_count */
	size_t input_count;
	panorama *map; /* owned; map_count: of environment lights, from loaded_scene_lights */
	size_t map_count;
	gw_light *light;      /* owned; settings.light_count: those that loaded_scene_lights found */
	char up;              /* as gw_camera_up has it */
	bool says_up;         /* an input says so itself */
	coordinates place;    /* owned; from the cloud's coordinates to those of `points`, metres */
	parted_cloud *parted; /* NULL; or of which file the cloud is a part, spread over it */
	gw_object_instance *instance; /* owned; instance_count: see scene_instances.h */
	size_t instance_count;
	double *scanner; /* owned; the cloud's scanners in metres, or NULL when those are the same */
} loaded_scene;

/*
 * Reads settings->input in order and joins them. Each input's colours are taken by themselves, so
 * that inputs may encode them differently. Meshes are moved, then sampled: at their own density,
 * else settings->density, else the median density of the largest cloud among the inputs, else so
 * that all such meshes together get settings->count points.
 *   scene   on success owned by the caller, freed with loaded_scene_clear; zeroed on failure
 *   error   of reading; GW_ERROR_DATA when an input holds no points; GW_ERROR_USAGE when inputs
 *           disagree about which axis is up; GW_ERROR_CANCELLED
 */
gw_status loaded_scene_read(const settings *settings, loaded_scene *scene, gw_error *error);
void loaded_scene_clear(loaded_scene *scene);

/* The same of a cloud that memory does not hold: as many of its points as do.
 *   parted   the only input, opened; it is referred to. NULL: all points of all inputs */
gw_status loaded_scene_read_parted(const settings *settings, parted_cloud *parted,
								   loaded_scene *scene, gw_error *error);

/* The points of a part of such a cloud, as parted_cloud_read brings them; of the scene that was
 * read of it the part has the axis that is up and the units. scene   to be given back with
 * loaded_scene_clear_part, which leaves the other one alone */
gw_status loaded_scene_read_part(const settings *settings, const loaded_scene *whole,
								 uint64_t number, loaded_scene *scene, gw_error *error);
/* The same of points of any parts of it. cloud   taken, and empty afterwards */
gw_status loaded_scene_take_part(const settings *settings, const loaded_scene *whole, scan *cloud,
								 loaded_scene *scene, gw_error *error);
void loaded_scene_clear_part(loaded_scene *scene);

/* Whether an input is sampled: it is asked for as a mesh, or its name is a mesh's, it has faces,
 * and neither the scene file nor --format asks for its vertices. */
bool loaded_scene_is_mesh(const settings *settings, const settings_input *from);

/* Points for a density. GW_ERROR_DATA when that is none, or more than can be counted.
 *   name    of the file, for messages */
gw_status loaded_scene_mesh_count(const mesh *mesh, double density, const char *name,
								  uint64_t *count, gw_error *error);

/* A lamp's place and target in metres, and its direction. */
void loaded_scene_place(const coordinates *place, char up, lamp *light);

/* Puts lights that stand at scanners or on free floor there, and aims them. GW_ERROR_USAGE when
 * there is no such place. */
gw_status loaded_scene_name_places(const loaded_scene *scene, settings *settings, gw_error *error);

/* The lights as the bake takes them, with directions from the sky resolved; *lights is the caller's
 * to free, the pixels of their maps are the scene's. GW_ERROR_USAGE when nothing in the scene gives
 * light. */
gw_status loaded_scene_lights(loaded_scene *scene, settings *settings, gw_light **lights,
							  gw_error *error);

/* Gives light i of a frame, a resolved lamp, the map that loaded_scene_lights read for it, and the
 * scale that this was found to need. */
void loaded_scene_put_map(const loaded_scene *scene, const lamp *light, size_t i, gw_light *to);

/* The name for messages: the path, or "standard input". */
const char *loaded_scene_input_name(const char *path);

#endif
