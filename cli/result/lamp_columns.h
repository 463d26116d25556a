/*
 * lamp_columns.h - columns scalar_light_NAME_r, _g, _b with what each lamp adds to the radiance,
 * for `glowworm mix`.
 */
#ifndef LAMP_COLUMNS_H
#define LAMP_COLUMNS_H

#include "points/scan.h"
#include "options/settings.h"

/* Room for the name of one lamp's columns, without scalar_light_ and channel. */
#define LAMP_COLUMN_NAME 72

/*
 * The names of the lamps of a scene: as given, in letters that every program takes (others become
 * _); a lamp without a name is called by its type; a name that is taken, or "rest", gets a number.
 *   name   receives s->light_count of them
 */
void lamp_columns_name(const settings *s, char (*name)[LAMP_COLUMN_NAME]);

/* Adds the columns of all lamps, and rest_ with the light of points that emit when there are such.
 */
gw_status lamp_columns_add(scan *lit, const gw_bake_result *result, const settings *s,
						   gw_error *error);

/* Removes such columns of an earlier bake. */
void lamp_columns_remove(scan *cloud);

#endif
