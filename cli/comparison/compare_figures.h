/*
 * compare_figures.h - how far one lit cloud is from another: figures of each quantity that both
 * have, as a table and as JSON.
 */
#ifndef COMPARE_FIGURES_H
#define COMPARE_FIGURES_H

#include "glowworm_picture.h"
#include "comparison/matched_scans.h"
#include "options/settings.h"

#include <stdio.h>

typedef enum compare_row {
	COMPARE_LUMINANCE,
	COMPARE_RED,
	COMPARE_GREEN,
	COMPARE_BLUE,
	COMPARE_ROWS
} compare_row;

#define COMPARE_COMPONENTS 6

/* The figures of one quantity: radiance, its two parts, irradiance or its two. */
typedef struct compare_component {
	const char *name;
	gw_comparison row[COMPARE_ROWS];
} compare_component;

typedef struct compare_figures {
	const matched_scans *match;
	compare_component component[COMPARE_COMPONENTS]; /* radiance is the first */
	size_t component_count;
	double *error;      /* owned; of each pair, difference of luminance / mean of the truth */
	double truth_error; /* RMS of the truth's own standard error / its mean; NAN: not known */
} compare_figures;

/*
 * Compares all that both clouds have. Radiance is `radiance_*` with or without CloudCompare's
 * prefix; the other quantities must have the same names in both.
 *
 *   figures  filled in, to be freed with compare_figures_clear
 *   error    GW_ERROR_DATA when one has no radiance, or radiance that is not finite
 */
gw_status compare_figures_make(const matched_scans *match, compare_figures *figures,
							   gw_error *error);
void compare_figures_clear(compare_figures *figures);

/* Prints a table for people. */
void compare_figures_print(const compare_figures *figures, FILE *out);

/* Prints one JSON object. missed: whether a limit of the settings is exceeded. */
void compare_figures_json(const compare_figures *figures, bool missed, FILE *out);

/* Holds the figures against the limits: STATUS_MISSED and which one is exceeded, or GW_OK. */
gw_status compare_figures_check(const compare_figures *figures, const settings *settings,
								gw_error *error);

#endif
