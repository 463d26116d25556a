/*
 * format.h - what a file format is. Each format is one file that exports one const struct;
 * format_table.h has the table of them.
 */
#ifndef FORMAT_H
#define FORMAT_H

#include "points/scan.h"

struct output_file; /* output_file.h: temporary name, checked writes, renamed when whole */
struct input_file;  /* input_file.h: a file or standard input as bytes in memory, with its length */

/* Some of the points of a file. */
typedef struct format_rows {
	uint64_t first, count;
} format_rows;

typedef struct format {
	const char *name;              /* "ply", as on the command line */
	const char *description;       /* for --help, a few words */
	const char *const *extensions; /* NULL-terminated, lower case without the dot */
	char custom_up;                /* the axis that is up in most files of a format that does not
									  say; 0: nobody knows */

	/* True when the first `length` bytes of a file look like this format, of which at least the
	 * first 4096 are given if the file has them. NULL: by extension only. */
	bool (*probe)(const uint8_t *head, size_t length);
	bool unspecific; /* probe also takes others' files: an extension that is known goes before it */

	/* Reads a whole scan. On failure *scan is empty. NULL when the format cannot be read. Every
	 * count is checked against the bytes that are there before anything is allocated. */
	gw_status (*read)(struct input_file *in, scan *scan, gw_error *error);

	/* How many points a file has, where they can be read in parts; 0 where they can not. NULL: they
	 * never can.
	 *   together   receives how many are read at once: parts of a multiple of that cost the least
	 */
	uint64_t (*count_rows)(struct input_file *in, uint64_t *together);

	/* Between which corners the points lie, by what stands before them, which may be wrong; false
	 * when nothing does. NULL: the format never says. */
	bool (*say_bounds)(struct input_file *in, double minimum[3], double maximum[3]);

	/* Reads the points [first, first + count), as read would have them, with all else that the file
	 * says. On failure *scan is empty. */
	gw_status (*read_rows)(struct input_file *in, const format_rows *rows, scan *scan,
						   gw_error *error);

	/* Does what read does with the points of a whole file, and read_rows cannot do with a part, to
	 * points that were kept of all parts: it leaves out columns that hold nothing, finds scanners.
	 * NULL: nothing.
	 *   zero   kept->column_count: whether a column is 0 at all points of the file */
	gw_status (*settle_rows)(struct input_file *in, const bool *zero, scan *kept, gw_error *error);

	/* Whether the format can hold the coordinates of a scan; NULL: those of any.
	 *   name   of the file, for messages */
	gw_status (*accept)(const scan *scan, const char *name, gw_error *error);

	/* What a point takes at least when it is written. */
	size_t row_bytes; /* 0: what its columns take, */
	bool text;        /* or a digit and a separator for each of them */

	/* Writes a scan: all columns in order. NULL when the format cannot be written. */
	gw_status (*write)(struct output_file *out, const scan *scan, gw_error *error);

	/* The same in parts, or NULL: what goes before all points, which are as many as rows->count and
	 * have the columns of a scan; then scan after scan. */
	gw_status (*write_head)(struct output_file *out, const format_rows *rows, const scan *scan,
							gw_error *error);
	gw_status (*write_rows)(struct output_file *out, const scan *scan, gw_error *error);
} format;

/* How to read a file; zeros ask the file itself. */
typedef struct format_options {
	const char *name;    /* the format to insist on, or NULL */
	const char *columns; /* names of the columns of tables without names, as "x,y,z,-,intensity":
							- leaves one out. Formats that name their columns take no notice */
	uint32_t threads;    /* 0 means one a processor */
} format_options;

#endif
