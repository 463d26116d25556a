/*
 * gathered_points.h - points that come one piece after the other, of one file or several, kept on
 * the disk, from where any of them are read again as if they had come of one file.
 *
 * They are joined as scan_append joins scans: a column that some pieces have all points have, in a
 * type that holds the values of all, 0 where none came, and opaque. Colours of files that count to
 * different numbers are scaled to count to one. What pieces say besides, comments and where
 * scanners stood, all of them say; which of these saw a point is known of it. Pictures that points
 * made are forgotten.
 *
 * The file has no name, so that none is left whatever ends the program.
 */
#ifndef GATHERED_POINTS_H
#define GATHERED_POINTS_H

#include "points/scan.h"

typedef struct gathered_points gathered_points;

/*
 * Begins to gather.
 *   beside   a path in whose folder the file is made
 *   points   to be given back with gathered_points_close; NULL on failure
 *   error    FILE_ERROR_CREATE where no file can be made there; GW_ERROR_MEMORY
 */
gw_status gathered_points_begin(const char *beside, gathered_points **points, gw_error *error);

/* Pieces that follow are of another file than those before. GW_ERROR_MEMORY. */
gw_status gathered_points_next_file(gathered_points *points, gw_error *error);

/* Adds a piece behind those before it. FILE_ERROR_IO when the disk does not take it;
 * GW_ERROR_MEMORY. */
gw_status gathered_points_add(gathered_points *points, const scan *piece, gw_error *error);

/* All pieces are there. */
void gathered_points_settle(gathered_points *points);

/* How many points there are, and bytes of them on the disk. */
uint64_t gathered_points_count(const gathered_points *points);
uint64_t gathered_points_bytes(const gathered_points *points);

/* Those of a file, and the rows that had none: files are numbered from 0 as they came. */
uint64_t gathered_points_of_file(const gathered_points *points, size_t file, uint64_t *left_out);

/*
 * Reads the points [first, first + count), which are there, once all are. Calls for the same points
 * may run at the same time.
 *   part   to be freed with scan_clear; empty on failure: FILE_ERROR_IO, GW_ERROR_MEMORY
 */
gw_status gathered_points_read(const gathered_points *points, uint64_t first, size_t count,
							   scan *part, gw_error *error);

void gathered_points_close(gathered_points **points); /* NULL is accepted; sets it to NULL */

#endif
