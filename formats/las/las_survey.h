/*
 * las_survey.h - what has to be known of all points before LAS can be written: their grid, which
 * fields hold the values of the columns that are called like them, and what the header counts.
 */
#ifndef LAS_SURVEY_H
#define LAS_SURVEY_H

#include "las/las_fields.h"
#include "las/las_grid.h"
#include "points/format.h"
#include "points/scan_color.h"

struct laz_output;

/* Formats 0 to 5, and those after them. */
enum { LAS_OLD, LAS_NEW, LAS_AGES };

/* LAS's own part of format.parted. */
typedef struct format_survey {
	const char *name;     /* of the file, for messages */
	uint64_t count;       /* points */
	uint64_t returns[15]; /* points with each return number */
	las_grid_search axis[3];
	scan_color_tally color;
	las_layout layout[LAS_AGES];
	uint8_t *fits[LAS_AGES];   /* owned; of each field LAS_SURVEY_ bits */
	bool again;                /* not in the first round */
	struct laz_output *packed; /* of LAZ that is written in parts: laz_output.h */
} las_survey;

/* A column is called like a field; some value of it does not go there. */
enum { LAS_SURVEY_SEEN = 1, LAS_SURVEY_UNFIT = 2 };

/*
 * Begins one.
 *   survey   to be given back with las_survey_clear, also on failure
 *   name     must live as long
 */
gw_status las_survey_begin(las_survey *survey, const char *name, gw_error *error);

/* Adds a part. GW_ERROR_DATA when LAS cannot hold its coordinates; GW_ERROR_MEMORY. */
gw_status las_survey_add(las_survey *survey, const scan *part, gw_error *error);

/* To be called after all parts: sets *again when all have to be added once more. */
gw_status las_survey_go_on(las_survey *survey, bool *again, gw_error *error);

/* The whole survey of a scan that has all points. Fails like las_survey_add. */
gw_status las_survey_all(las_survey *survey, const scan *cloud, gw_error *error);

/* Whether a field holds every value of a column exactly. */
bool las_survey_fits(const las_survey *survey, unsigned age, const las_field *field,
					 const scan_column *column);

void las_survey_clear(las_survey *survey);

#endif
