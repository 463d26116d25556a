/*
 * options.h - the one table of options, and values to and from text.
 *
 * Parsing, --help, manual, completions and the keys of "bake" in a scene file all come from this
 * table; default values come from settings_default().
 */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "options/settings.h"

typedef enum option_type {
	OPTION_FLAG,    /* bool */
	OPTION_TEXT,    /* const char * */
	OPTION_CHOICE,  /* int, one of option.choice */
	OPTION_VIEW,    /* int, as CHOICE; what stands behind a colon is settings_render.detail */
	OPTION_COUNT,   /* uint32_t */
	OPTION_SEED,    /* uint64_t */
	OPTION_SIZE,    /* uint64_t, bytes; K, M, G, T behind it */
	OPTION_REAL,    /* float */
	OPTION_LIGHT,   /* added to the lights */
	OPTION_ALBEDO,  /* source of the albedo */
	OPTION_SCANNER, /* X,Y,Z or @FILE, added to the scanners */
	OPTION_GAIN,    /* NAME=FACTOR, added to the gains */
	OPTION_GROUP,   /* the same for a group of lamps */
	OPTION_SETUP,   /* NAME: LAMP=FACTOR ..., added to the gains */
	OPTION_CAMERA,  /* a camera, added to those of a page */
	OPTION_FIELDS,  /* uint32_t, 1 << choice, a list with commas */
	OPTION_EFFECTS, /* a settings_effects, and those of bake: auto, all, NAME, +NAME, -NAME */
} option_type;

/* What an option has to do with what comes out. */
typedef enum option_effect {
	OPTION_CHANGES_POINTS, /* belongs into the command that a lit file quotes */
	OPTION_LEAVES_POINTS,  /* where to write, how to report, how fast */
} option_effect;

typedef struct option {
	const char *name; /* without dashes */
	char letter;      /* or 0 */
	const char *argument;
	option_type type;
	option_effect effect;
	unsigned verbs;             /* 1 << verb */
	unsigned common;            /* of these, those whose short help has it */
	bool scene;                 /* also a key of "bake", with _ for - */
	size_t offset;              /* in settings */
	const char *(*choice)(int); /* names of CHOICE and FIELDS, NULL behind the last */
	double minimum, maximum;    /* of COUNT and REAL */
	bool open;                  /* the limits themselves are not allowed */
	const char *automatic;      /* word for the automatic value, or NULL */
	double automatic_value;
	const char *group; /* heading in --help */
	const char *help;  /* without the default */
} option;

extern const option options[]; /* name of the last is NULL */

/* Room for a value as text. */
#define OPTION_VALUE 256

/* What stands behind the option in a synopsis: "rays|cones" for a choice, else its argument. */
void option_argument(const option *option, char text[OPTION_VALUE]);

/* Whether it may be given many times, each adding to the last. */
bool option_repeats(const option *option);

/* Legal values as a phrase ("rays or cones", "1 to 16, or auto"); empty when any text goes. */
void option_legal(const option *option, char text[OPTION_VALUE]);

/* Sets a value from text. GW_ERROR_USAGE with a phrase: what is wrong, what is legal. */
gw_status option_set(const option *option, settings *settings, const char *text, gw_error *error);

/* The value as text that option_set takes; false when there is none to show (a text not given). */
bool option_print(const option *option, const settings *settings, char text[OPTION_VALUE]);

/* The option called so for this verb, or NULL. length: of name. */
const option *option_find(verb verb, const char *name, size_t length);

/* The option whose scene key this is ("light_samples"), or NULL; and its key. */
const option *option_find_key(const char *key);
void option_key(const option *option, char key[64]);

/* Reads the arguments behind the verb. */
gw_status options_parse(verb verb, int count, char *const *argument, settings *settings,
						gw_error *error);

/* Names of verbs: "bake". NULL behind the last. */
const char *verb_name(int verb);
const char *verb_summary(verb verb);    /* one sentence */
const char *verb_synopsis(verb verb);   /* behind "glowworm " */
const char *verb_group_name(int group); /* headings in the list of verbs; NULL behind the last */
int verb_group(verb verb);
const char *verb_examples(verb verb); /* commands, a line each */

#endif
