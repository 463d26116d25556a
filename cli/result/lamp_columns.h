/*
 * lamp_columns.h - columns scalar_light_NAME_r, _g, _b with what each lamp adds to the radiance,
 * for `glowworm mix`.
 */
#ifndef LAMP_COLUMNS_H
#define LAMP_COLUMNS_H

#include "points/scan.h"
#include "options/settings.h"

/* Adds the columns of all lamps, and rest_ with the light of points that emit when there are such.
 */
gw_status lamp_columns_add(scan *lit, const gw_bake_result *result, const settings *s,
						   gw_error *error);

/* Removes such columns of an earlier bake. */
void lamp_columns_remove(scan *cloud);

#endif
