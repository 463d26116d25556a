/*
 * sky_light.h - skies as light: maps from files or models, and all skies of a scene together.
 */
#ifndef SKY_LIGHT_H
#define SKY_LIGHT_H

#include "options/settings.h"
#include "panoramas/panorama.h"

/*
 * Reads or makes the map of a lamp that has a file or a model, and scales the lamp to what it is to
 * give.
 *   light   resolved (light_resolve)
 *   up      as gw_camera_up has it: GW_ERROR_USAGE unless y or z points up
 *   map     on success the caller's
 */
gw_status sky_light_map(lamp *light, char up, panorama *map, gw_error *error);

/* What comes from outside in pictures. */
typedef struct sky_light {
	float radiance[3]; /* of all even skies together */
	bool has_map;
	gw_light light; /* with the map, then */
	panorama map;   /* owned */
} sky_light;

/* Finds the skies among the lights. GW_ERROR_USAGE when two of them have maps. */
gw_status sky_light_find(const settings *settings, char up, sky_light *sky, gw_error *error);
void sky_light_clear(sky_light *sky);

#endif
