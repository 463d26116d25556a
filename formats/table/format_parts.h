/*
 * format_parts.h - a file's points part by part, or those of several that were gathered, for those
 * that memory does not hold at once.
 */
#ifndef FORMAT_PARTS_H
#define FORMAT_PARTS_H

#include "files/input_file.h"
#include "points/format.h"
#include "table/gathered_points.h"

typedef struct format_parts {
	input_file in;
	const format *found;       /* NULL: the file cannot be read in parts */
	gathered_points *gathered; /* owned; NULL, or in place of the file */
	uint64_t count;            /* points of the file */
	uint64_t together;         /* that are read at once: see format.count_rows */
	/* Of the columns that parts come with: */
	bool *zero;     /* 0 at all points that were read */
	bool *left_out; /* not in what was kept; NULL: none yet */
	size_t columns;
	double minimum[3], maximum[3]; /* of the finite coordinates that were read before that; the one
									  above the other: there are none */
} format_parts;

/*
 * Opens a file, if it is one whose points can be read in parts: no pipe, not empty, and of a format
 * and in an encoding that allow it. A file that is not there is left to whoever reads it whole.
 *   parts     to be given back with format_parts_close, also where found is NULL
 *   options   as for format_read_with
 * Fails like input_file_open_as.
 */
gw_status format_parts_open(const char *path, const format_options *options, format_parts *parts,
							gw_error *error);

/*
 * The same of points that were gathered; `name` stands for their file in messages, and lives as
 * long. gathered   all are there; taken
 */
void format_parts_of_gathered(gathered_points *gathered, const char *name, format_parts *parts);

/*
 * Reads the points [first, first + count), or those of them that there are; what else the file says
 * is in every part, but what only all of its points tell is in none.
 *   part   to be freed with scan_clear; empty on failure
 */
gw_status format_parts_read(format_parts *parts, uint64_t first, size_t count, scan *part,
							gw_error *error);

/*
 * Finishes points that were kept of all parts, each of which has been read: columns of no use are
 * left out, scanners found, and wrong bounds noted. GW_ERROR_MEMORY.
 */
gw_status format_parts_settle(format_parts *parts, scan *kept, gw_error *error);

/* Whether only all points at once may tell more, as far as parts that were read say it: where
 * scanners were. To be asked before points are finished.
 *   some   such a part, or some of its points */
bool format_parts_need_all(const format_parts *parts, const scan *some);

/* From now on parts have the columns that such points have. Fails like format_parts_read. */
gw_status format_parts_follow(format_parts *parts, const scan *kept, gw_error *error);

/*
 * Surveys all points of the file for a format in which they will be written part by part; nothing,
 * where the format does not ask for it.
 *   whole   its name is set; count and survey are received. To be given back with
 *           format_whole_clear, also on failure
 *   check   asked now and then; its failure ends the survey
 */
typedef struct format_survey_use {
	const format *format;
	size_t step; /* points that are read at once */
	gw_status (*check)(gw_error *error);
} format_survey_use;
gw_status format_parts_survey(format_parts *parts, const format_survey_use *use,
							  format_whole *whole, gw_error *error);
void format_whole_clear(const format *to, format_whole *whole);

/* Bytes of a row of a scan in such a file. */
gw_status format_whole_row(const format *to, const format_whole *whole, const scan *part,
						   size_t *row, gw_error *error);

void format_parts_close(format_parts *parts);

#endif
