/*
 * bake_columns.h - the columns that a bake writes beside those that came in.
 */
#ifndef BAKE_COLUMNS_H
#define BAKE_COLUMNS_H

#include "points/scan.h"

/* Which of them. */
typedef enum bake_columns {
	BAKE_COLUMNS_ALL,
	BAKE_COLUMNS_OF_LIGHT, /* those that are wrong once lamps are dimmed; radiance and luminance as
							  quality, which are made again, are not among them */
} bake_columns;

/* Removes those of an earlier bake, but not scalar_light_* (lamp_columns.h); returns how many. */
size_t bake_columns_remove(scan *cloud, bake_columns which);

/* Rounds the columns of light, those of lamps too, to as many bits as a half float has: 11, so that
 * a value is off by 2^-11 of itself at most, however large or small it is. */
void bake_columns_round(scan *cloud);

/* Does the cloud say that its light is in cd/m^2 and lx, not in W/(sr m^2) and W/m^2? */
bool bake_columns_photometric(const scan *cloud);

#endif
