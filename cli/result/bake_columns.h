/*
 * bake_columns.h - the columns that a bake writes beside those that came in.
 */
#ifndef BAKE_COLUMNS_H
#define BAKE_COLUMNS_H

#include "options/settings.h"
#include "points/scan.h"

/* Which of them. */
typedef enum bake_columns {
	BAKE_COLUMNS_ALL,
	BAKE_COLUMNS_OF_LIGHT, /* those that are wrong once lamps are dimmed; radiance and luminance as
							  quality, which are made again, are not among them */
} bake_columns;

/* Removes those of an earlier bake, but not scalar_light_* (lamp_columns.h); returns how many. */
size_t bake_columns_remove(scan *cloud, bake_columns which);

/* Whether a column of that name is a bake's light, or made of it. */
bool bake_columns_is_light(const char *name);

/*
 * Rounds what options ask for. Of light, the columns of lamps too, --las-radiance keeps 11 bits, as
 * half floats have them, or 8: a value is off by 2^-11 or 2^-8 of itself at most, however large or
 * small it is. With --las-step normals become multiples of BAKE_COLUMNS_NORMAL_STEP, and
 * coordinates are told to lie on a grid of that step, which is the writer's to do.
 */
#define BAKE_COLUMNS_NORMAL_STEP 0x1p-11
void bake_columns_round(scan *cloud, const settings *s);

/* Does the cloud say that its light is in cd/m^2 and lx, not in W/(sr m^2) and W/m^2? */
bool bake_columns_photometric(const scan *cloud);

#endif
