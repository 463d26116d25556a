/*
 * format_table.h - the table of file formats, which is all that the program knows about them.
 */
#ifndef FORMAT_TABLE_H
#define FORMAT_TABLE_H

#include "points/format.h"

extern const format *const formats[]; /* NULL-terminated */

/* The format called `name`, or the one whose extension `path` has; NULL when there is none. */
const format *format_by_name(const char *name);
const format *format_by_path(const char *path);

/* Where a path's extension begins, with its dot: that of a format (".copc.laz"), else what is
 * behind the last dot of the name; the end of the path when there is none. */
const char *format_extension(const char *path);

/*
 * Reads a scan from a file, format found by content, then by extension.
 *   path     "-" is standard input
 *   options  NULL: all zeros
 *   found    receives the format that it was; may be NULL
 */
gw_status format_read_with(const char *path, const format_options *options, scan *scan,
						   const format **found, gw_error *error);

/* The format of a file by its content, then by its extension, or the one that is called `name`,
 * unless that is NULL. NULL when there is none. */
const format *format_recognise(const char *path, const char *name, const struct input_file *in);

/* What is the same for all formats once they are read: packed colours, scanners and the axis that
 * points up as a lit file says them. Hands the status back, of reading or of its own; what failed
 * is cleared. */
gw_status format_finish(scan *scan, gw_status status, gw_error *error);

/* The same with nothing but the name of the format to insist on, or NULL. */
gw_status format_read(const char *path, const char *name, scan *scan, gw_error *error);

#endif
