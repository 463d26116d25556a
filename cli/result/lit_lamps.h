/*
 * lit_lamps.h - the lamps of a lit cloud: its columns scalar_light_NAME_r, _g and _b, in each the
 * radiance that one lamp alone gives, all reflections included.
 *
 * What no lamp gives (emission of points, sky without a name) is the lamp called rest. NAME is
 * GROUP.OWN where a lamp belongs to a group.
 */
#ifndef LIT_LAMPS_H
#define LIT_LAMPS_H

#include "points/scan.h"
#include "options/settings.h"

#define LIT_LAMPS_PREFIX "scalar_light_"

/* One lamp: its columns by their places, because columns move when others are added. */
typedef struct lit_lamp {
	char *name; /* owned */
	size_t column[3];
} lit_lamp;

/* Zeroed: none. */
typedef struct lit_lamps {
	lit_lamp *lamp; /* owned; count */
	size_t count;
} lit_lamps;

/*
 * Finds all lamps, in the order of their first columns.
 *   lamps   freed with lit_lamps_clear, also on failure; count is 0 where the cloud has none
 *   error   GW_ERROR_DATA when one lacks a channel; GW_ERROR_MEMORY
 */
gw_status lit_lamps_find(const scan *cloud, lit_lamps *lamps, gw_error *error);
void lit_lamps_clear(lit_lamps *lamps);

/* Bytes of a lamp's name that are its group's, without the dot; 0: it belongs to none. */
size_t lit_lamp_group(const lit_lamp *of);

/* Whether a gain is for a lamp: by its whole name, or, where that is no lamp's, by its own; or by
 * its group, which may stand in one column of its name. */
bool lit_lamps_is_meant(const lit_lamps *lamps, size_t number, const settings_gain *gain);

/* Fails with GW_ERROR_USAGE, a sentence that names those that there are. */
gw_status lit_lamps_fail_unknown(const lit_lamps *lamps, const settings_gain *gain,
								 gw_error *error);

#endif
