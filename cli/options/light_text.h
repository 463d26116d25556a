/*
 * light_text.h - lights as the user writes them: what words there are, and lights from text.
 *
 * A light is its type and pairs of key and value. The same keys are the scene file's, so both take
 * their names, and which light has which, from one table here.
 */
#ifndef LIGHT_TEXT_H
#define LIGHT_TEXT_H

#include "glowworm.h"

#define LIGHT_MAP_PATH 1024

/* A light, with what can only be worked out when it is known which way is up. */
typedef struct lamp {
	gw_light light;
	bool from_sky;    /* its direction comes from azimuth and elevation */
	double azimuth;   /* degrees clockwise from +y, of the sun */
	double elevation; /* degrees above the horizon */
	bool aimed;       /* its direction leads from its position to the target */
	double target[3];
	size_t motion;            /* 0: it stands still; else its path, settings.path[motion - 1] */
	char map[LIGHT_MAP_PATH]; /* file with the map of an environment; "" for none */
} lamp;

/* What stands behind a key. */
typedef enum light_value {
	LIGHT_VALUE_VECTOR, /* three numbers */
	LIGHT_VALUE_COLOR,  /* one number, or three; 0 or more */
	LIGHT_VALUE_SKY,    /* azimuth and elevation */
	LIGHT_VALUE_NUMBER, /* 0 or more */
	LIGHT_VALUE_ANGLE,  /* of either sign */
	LIGHT_VALUE_NAME,
	LIGHT_VALUE_PATH,
} light_value;

typedef enum light_key_id {
	LIGHT_KEY_POSITION,
	LIGHT_KEY_TARGET,
	LIGHT_KEY_DIRECTION,
	LIGHT_KEY_SKY,
	LIGHT_KEY_INTENSITY,
	LIGHT_KEY_IRRADIANCE,
	LIGHT_KEY_RADIANCE,
	LIGHT_KEY_MAP,
	LIGHT_KEY_ROTATION,
	LIGHT_KEY_INNER,
	LIGHT_KEY_OUTER,
	LIGHT_KEY_RADIUS,
	LIGHT_KEY_ANGLE,
	LIGHT_KEY_NAME,
	LIGHT_KEY_COUNT
} light_key_id;

typedef struct light_key {
	const char *word; /* on the command line; NULL: only the scene file's name */
	const char *name; /* in the scene file; NULL: only on the command line */
	light_value value;
	unsigned types;  /* 1 << gw_light_type for each that has it */
	unsigned needed; /* those that cannot do without it */
	const char *help;
} light_key;

extern const light_key light_keys[LIGHT_KEY_COUNT];

/* The type called `word` ("sky" is an environment); GW_LIGHT_TYPE_COUNT when there is none. */
gw_light_type light_type_by_name(const char *word);

/* Writes the names of the types, for messages. */
void light_list_types(char *text, size_t size);

/* A light of that type with the values that its keys have when they are not given: outer angle 45
 * degrees, a sun of 0.53 degrees, an environment of radiance 1 (if it has a map). */
lamp light_default(gw_light_type type);

/*
 * Sets one key. values: 1 to 3 numbers as the key wants; a COLOR of one number is white.
 * GW_ERROR_USAGE with a phrase ("must be 0 or more") when they are out of range.
 */
gw_status light_set(lamp *light, light_key_id key, const double *values, size_t count,
					gw_error *error);

/* The same for a NAME or a PATH. */
gw_status light_set_text(lamp *light, light_key_id key, const char *text, gw_error *error);

/* GW_ERROR_USAGE when a needed key is missing or two do not go together. given: 1 << light_key_id
 * for each that was set; scene: whose names the message uses. */
gw_status light_check(const lamp *light, unsigned given, bool scene, gw_error *error);

/* Reads the text of one --light. Failures name the word and where it stands. */
gw_status light_from_text(const char *text, lamp *light, gw_error *error);

/* Works out the direction. up: as gw_camera_up has it; north is the back of gw_camera_stand, which
 * is y with z up and -z with y up. */
void light_resolve(lamp *light, char up);

#endif
