/*
 * light_preset.h - lamps that have names of their own: what stands behind "candle at 1,2,3".
 *
 * One table, from which lights on the command line and in scene files, help, manual and the list of
 * `glowworm lamp` come. Each number has its source.
 */
#ifndef LIGHT_PRESET_H
#define LIGHT_PRESET_H

#include "lamps/light_text.h"

typedef struct light_preset {
	const char *name;
	gw_light_type type;
	const char *keys;      /* as in --light, behind the type; what else is said wins over them */
	unsigned needed;       /* 1 << light_key_id of what has to be said beside what the type needs */
	const char *about;     /* half a sentence: what it is */
	const char *estimated; /* from what its intensity is estimated; NULL where it was measured */
	const char *source;
} light_preset;

/* NULL as name ends it. */
extern const light_preset light_presets[];

/* NULL when there is none of that name. */
const light_preset *light_preset_find(const char *name);

#endif
