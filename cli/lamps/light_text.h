/*
 * light_text.h - lights as the user writes them: what words there are, and lights from text.
 *
 * A light is its type and pairs of key and value. The same keys are the scene file's, so both take
 * their names, and which light has which, from one table here.
 */
#ifndef LIGHT_TEXT_H
#define LIGHT_TEXT_H

#include "lamps/light_unit.h"
#include "lamps/sky_model.h"
#include "lamps/sun_position.h"
#include "luminaires/luminaire.h"

#define LIGHT_MAP_PATH 1024

/* Illuminance at the end of a beam, lx: that of a full moon, by ANSI/PLATO FL 1. */
#define LIGHT_BEAM_END 0.25

/* How high a light is above a place of the floor when nothing else is said, metres: about where a
 * headlamp is. */
#define LIGHT_FLOOR_HEIGHT 1.5

/* Names that lights can begin with: types, sky, presets. */
#define LIGHT_NAMES_MAX 32

/* What stands behind a key. */
typedef enum light_value {
	LIGHT_VALUE_VECTOR, /* three numbers */
	LIGHT_VALUE_COLOR,  /* one number, or three; 0 or more */
	LIGHT_VALUE_SKY,    /* azimuth and elevation */
	LIGHT_VALUE_PLACE,  /* latitude and longitude */
	LIGHT_VALUE_SIZE,   /* two numbers, width and height */
	LIGHT_VALUE_NUMBER, /* 0 or more */
	LIGHT_VALUE_ANGLE,  /* of either sign */
	LIGHT_VALUE_NAME,
	LIGHT_VALUE_PATH,
	LIGHT_VALUE_TIME,
	LIGHT_VALUE_MODEL, /* the name of a sky_model */
} light_value;

typedef enum light_key_id {
	LIGHT_KEY_POSITION,
	LIGHT_KEY_TARGET,
	LIGHT_KEY_DIRECTION,
	LIGHT_KEY_IES,
	LIGHT_KEY_ROLL,
	LIGHT_KEY_SCALE,
	LIGHT_KEY_SKY,
	LIGHT_KEY_PLACE,
	LIGHT_KEY_TIME,
	LIGHT_KEY_NORTH,
	LIGHT_KEY_INTENSITY,
	LIGHT_KEY_LUMENS,
	LIGHT_KEY_WATTS,
	LIGHT_KEY_IRRADIANCE,
	LIGHT_KEY_RADIANCE,
	LIGHT_KEY_ILLUMINANCE,
	LIGHT_KEY_KELVIN,
	LIGHT_KEY_MODEL,
	LIGHT_KEY_TURBIDITY,
	LIGHT_KEY_HORIZON,
	LIGHT_KEY_MAP,
	LIGHT_KEY_ROTATION,
	LIGHT_KEY_INNER,
	LIGHT_KEY_OUTER,
	LIGHT_KEY_DISTANCE,
	LIGHT_KEY_RADIUS,
	LIGHT_KEY_SIZE,
	LIGHT_KEY_ANGLE,
	LIGHT_KEY_NAME,
	LIGHT_KEY_GROUP,
	LIGHT_KEY_COUNT
} light_key_id;

/* Places that have names; where they are shows when the inputs are read. */
typedef enum light_place_kind {
	LIGHT_PLACE_NONE, /* it is said in coordinates */
	LIGHT_PLACE_SCANNER,
	LIGHT_PLACE_FLOOR,
} light_place_kind;

typedef struct light_place {
	light_place_kind kind;
	size_t number; /* from 1 */
	double height; /* metres above the floor */
} light_place;

/* A light, with what can only be worked out when all its keys are known, and which way is up. */
typedef struct lamp {
	gw_light light;
	light_key_id measure; /* the key that says how much light; LIGHT_KEY_COUNT: none did */
	double amount[3];     /* what it says, linear RGB */
	bool white;           /* it was one number */
	light_units units;
	unsigned preset; /* 1 << light_key_id for what its name as a preset has said so far */
	unsigned wanted; /* likewise: what has to be said for that preset */
	double kelvin;   /* colour temperature; 0: none */

	light_place stand; /* where it is, in place of its position */
	light_place aim;   /* where it shines, in place of its target */
	bool from_sky;     /* its direction comes from azimuth and elevation */
	double azimuth;    /* degrees clockwise from north, of the sun */
	double elevation;  /* degrees above the horizon */
	double north;      /* degrees clockwise from +y in which north lies */
	sun_moment moment;
	bool aimed; /* its direction leads from its position to the target */
	double target[3];

	char ies[LIGHT_MAP_PATH];   /* file of a luminaire; "" for none */
	const luminaire *luminaire; /* as it was read; the settings' */
	double flux;                /* lumens that it gives by that file */
	double roll;                /* degrees clockwise, seen from behind */
	double scale;               /* times what the file or a key says */
	double distance;            /* metres at which it gives LIGHT_BEAM_END; 0: not said */
	bool hangs;                 /* it shines straight down */

	char group[64];           /* "" for none */
	size_t motion;            /* 0: it stands still; else its path, settings.path[motion - 1] */
	char map[LIGHT_MAP_PATH]; /* file with the map of an environment; "" for none */
	sky_model model;          /* in place of a map */
	double turbidity;
	float horizon[3];
} lamp;

typedef struct light_key {
	const char *word; /* on the command line; NULL: only the scene file's name */
	const char *name; /* in the scene file; NULL: only on the command line */
	light_value value;
	unsigned types;  /* 1 << gw_light_type for each that has it */
	unsigned needed; /* those that cannot do without it */
	const char *help;
} light_key;

extern const light_key light_keys[LIGHT_KEY_COUNT];

/*
 * Begins a light called by its type, as sky, or by a preset, of which it takes the keys; false when
 * there is none of that name.
 */
bool light_begin(const char *word, lamp *light);

/* All names that light_begin knows; returns how many. */
size_t light_names(const char *name[LIGHT_NAMES_MAX]);

/* Writes them, for messages. */
void light_list_names(char *text, size_t size);

/* A light of that type with the values that its keys have when they are not given: outer angle 45
 * degrees, a sun of 0.53 degrees, an environment of radiance 1 (if it has a map), turbidity 3. */
lamp light_default(gw_light_type type);

/* What the unit of a key's number can be; LIGHT_QUANTITY_COUNT: it has none. */
light_quantity light_key_quantity(light_key_id key);

/* What a value looks like, for messages: "three numbers X,Y,Z". */
const char *light_value_expected(light_value value);

/* Whether keyframes may hold the key: numbers that do not depend on others. */
bool light_key_moves(light_key_id key);

/*
 * Sets one key. values: 1 to 3 numbers as the key wants; a COLOR of one number is white.
 * GW_ERROR_USAGE with a phrase ("must be 0 or more") when they are out of range.
 */
gw_status light_set(lamp *light, light_key_id key, const double *values, size_t count,
					gw_error *error);

/* The same for a NAME, a PATH, a TIME or a MODEL. */
gw_status light_set_text(lamp *light, light_key_id key, const char *text, gw_error *error);

/* The same for numbers with commas between them, a unit behind them: "40cd", "1,0.8,0.5"; and for
 * places by name: "scanner:2", "floor:1+0.5". */
gw_status light_set_numbers(lamp *light, light_key_id key, const char *text, gw_error *error);

/*
 * When all keys are set: works out where the sun is. said: 1 << light_key_id for each that was
 * set; scene: whose names the message uses. GW_ERROR_USAGE when a needed key is missing or two do
 * not go together.
 */
gw_status light_complete(lamp *light, unsigned said, bool scene, gw_error *error);

/* GW_ERROR_USAGE when a light is to be as large as its luminaire, which was read, and that has
 * another shape. */
gw_status light_check_luminaire(const lamp *light, gw_error *error);

/* GW_ERROR_USAGE when some lights have photometric units, others radiometric ones, or others than
 * the scene, whose units become theirs. */
gw_status lights_agree(const lamp *lights, size_t count, light_units *scene, gw_error *error);

/* Reads the text of one --light. Failures name the word and where it stands. */
gw_status light_from_text(const char *text, lamp *light, gw_error *error);

/*
 * Works out direction and colour of the light: gw_light of a lamp whose keys are all set. It may be
 * called again when one of them changes.
 *   up  as gw_camera_up has it; +y, from which azimuths count, is the back of gw_camera_stand: with
 *       y up it is -z
 */
void light_resolve(lamp *light, char up);

/* What a light's key says is how much it gives, in the light's colour, linear RGB. */
void light_color(const lamp *light, float color[3]);

/* The map of a light that has a model, and what it is multiplied by, gw_light.radiance; call after
 * light_resolve. map: on success the caller's. GW_ERROR_MEMORY. */
gw_status light_sky(lamp *light, panorama *map, gw_error *error);

/* The same for a map that was read from a file; GW_ERROR_DATA when it is to give an illuminance and
 * is black above the horizon. */
gw_status light_scale_map(lamp *light, const panorama *map, gw_error *error);

#endif
