/*
 * info_facts.h - what there is to say of a file: quickly what its header tells, or a pass over its
 * points, and if asked for what all of them and their neighbours have to be looked at for.
 */
#ifndef INFO_FACTS_H
#define INFO_FACTS_H

#include "options/settings.h"
#include "points/format.h"
#include "result/lit_notes.h"
#include "units/coordinates.h"

/* What is known of one column. */
typedef struct column_range {
	double minimum, maximum;
	uint64_t bad; /* not finite */
} column_range;

typedef struct info_facts {
	const char *name;
	const format *format;
	scan cloud;          /* owned: all points, or the first of them */
	uint64_t points;     /* of the file */
	bool part;           /* ranges are those of the points in `cloud` alone, not of all */
	column_range *range; /* owned; cloud.column_count */
	bool bounded;        /* there are bounds, in metres, or in degrees */
	double minimum[3], maximum[3];
	coordinates place; /* owned: from the coordinates to metres, as all measures are */
	lit_notes lit;     /* owned */
	char up;           /* as scan_up has it, and whether y may be meant */
	bool up_doubtful;
	bool up_said;    /* by the user */
	bool up_unasked; /* how points lie was not looked at */

	/* Where it was asked for. */
	bool measured;
	scan_points of_points; /* owned */
	gw_statistics statistics;
	double albedo[3];     /* mean, linear */
	double normal_length; /* mean of the given ones */
} info_facts;

/* Of a file that can be read part by part and has more points than this the first tell of the
 * columns, if its header says the bounds. */
#define INFO_FIRST_POINTS 65536
/* And of one without bounds in its header, which is gone through, how points lie is not looked at.
 */
#define INFO_WHOLE_POINTS 4000000

/*
 * Reads a file and finds out what is asked for by s->stats and s->places.
 *   facts   to be freed with info_facts_clear, also on failure
 * Fails as format_read_with and coordinates_find do.
 */
gw_status info_facts_find(const settings *s, const char *path, info_facts *facts, gw_error *error);
void info_facts_clear(info_facts *facts);

/* Writes them to standard output, as text or as one JSON object on a line. */
void info_facts_print(const info_facts *facts);
void info_facts_print_json(const info_facts *facts);

#endif
