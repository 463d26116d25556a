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

#endif
