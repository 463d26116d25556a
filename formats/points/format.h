/*
 * format.h - what a file format is. Each format is one file that exports one const struct;
 * format_table.h has the table of them.
 */
#ifndef FORMAT_H
#define FORMAT_H

#include "points/scan.h"

struct format_survey;
struct output_file; /* output_file.h: temporary name, checked writes, renamed when whole */
struct input_file;  /* input_file.h: a file or standard input as bytes in memory, with its length */

/* Some of the points of a file. */
typedef struct format_rows {
	uint64_t first, count;
} format_rows;

/* What was seen of all points of a file that came part by part. */
typedef struct format_seen {
	const bool *zero; /* of each column that rows are read with: all its values are 0 */
	double minimum[3], maximum[3]; /* of finite coordinates; the one above the other: there are
									  none */
} format_seen;

/* A file that is written part by part. */
typedef struct format_whole {
	const char *name;             /* for messages; lives as long */
	uint64_t count;               /* points that will be in it */
	struct format_survey *survey; /* what its format knows of all of them, and keeps while it is
									 written; NULL: nothing */
} format_whole;

/* Rows of points, each as write_rows or write_loose has it. */
typedef struct format_loose {
	const uint8_t *bytes; /* row * count */
	size_t row, count;
} format_loose;

/* How files of a format are written part by part: all points are surveyed, in order, then comes
 * what goes before them, by the columns of the first; then part after part, and what goes behind.
 */
typedef struct format_parted {
	/* NULL: nothing has to be known of points before the first is written; then all of these are.
	 * The survey is given back by survey_clear, also on failure; NULL: by free. */
	gw_status (*survey_begin)(format_whole *whole, gw_error *error);
	gw_status (*survey_add)(format_whole *whole, const scan *part, gw_error *error);
	/* After all parts. Sets *again when all have to be added once more. Fails where the format
	 * cannot hold them. NULL: once is enough, and it holds all. */
	gw_status (*survey_go_on)(format_whole *whole, bool *again, gw_error *error);
	void (*survey_clear)(format_whole *whole);

	/* Bytes of a row; NULL: what its columns take. */
	gw_status (*row)(const format_whole *whole, const scan *part, size_t *row, gw_error *error);

	gw_status (*write_head)(struct output_file *out, const format_whole *whole, const scan *first,
							gw_error *error);
	gw_status (*write_rows)(struct output_file *out, const format_whole *whole, const scan *part,
							gw_error *error);
	gw_status (*write_end)(struct output_file *out, const format_whole *whole,
						   gw_error *error); /* NULL: nothing */

	bool any_length; /* rows have lengths of their own: parts are written in order, to any output */
	bool one_scan;   /* where several scanners stood, all points at once become more than parts */

	/* NULL: write_rows writes rows of that length, one after the other, wherever their place is.
	 * Else parts are written in order and to a file alone; then rows as such are written to any
	 * file by write_loose, and from there put where write_rows would have by pack_loose. */
	gw_status (*write_loose)(struct output_file *out, const format_whole *whole, const scan *part,
							 gw_error *error);
	gw_status (*pack_loose)(struct output_file *out, const format_whole *whole,
							const format_loose *rows, gw_error *error);
} format_parted;

/* How a file is read once from its begin to its end, some points at a time. */
typedef struct format_stream {
	/* How many points it has, about. */
	uint64_t (*guess)(struct input_file *in);

	/* Begins. What *state receives is given back by close, also on failure. */
	gw_status (*open)(struct input_file *in, void **state, gw_error *error);

	/* Reads the next points, at most so many, as read would have them, but that it doesn't look
	 * which pictures they make, and columns may be of narrower types than others hold. No points:
	 * they are all read. On failure *piece is empty. */
	gw_status (*next)(void *state, size_t most, scan *piece, gw_error *error);

	void (*close)(void *state); /* NULL is accepted */
} format_stream;

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

	bool packed; /* to read parts once more takes as long as to unpack them */

	/* Between which corners the points lie, by what stands before them, which may be wrong; false
	 * when nothing does. NULL: the format never says. */
	bool (*say_bounds)(struct input_file *in, double minimum[3], double maximum[3]);

	/* Reads the points [first, first + count), as read would have them, with all else that the file
	 * says. On failure *scan is empty. */
	gw_status (*read_rows)(struct input_file *in, const format_rows *rows, scan *scan,
						   gw_error *error);

	/* Does what read does with the points of a whole file, and read_rows cannot do with a part, to
	 * points that were kept of all parts: it leaves out columns that hold nothing, finds scanners,
	 * says that bounds are wrong. NULL: nothing. */
	gw_status (*settle_rows)(struct input_file *in, const format_seen *seen, scan *kept,
							 gw_error *error);

	/* Whether read may find more in all points than settle_rows in some of them, which are as they
	 * were read: where scanners were. NULL: never. */
	bool (*needs_all)(const scan *some, const format_seen *seen);

	/* How it is read some points at a time where it cannot be read in parts, or NULL. */
	const format_stream *stream;

	/* Whether the format can hold the coordinates of a scan; NULL: those of any.
	 *   name   of the file, for messages */
	gw_status (*accept)(const scan *scan, const char *name, gw_error *error);

	/* The names of all columns that it has room for, NULL-terminated; NULL: those of any. */
	const char *const *columns;

	/* What a point takes at least when it is written. */
	size_t row_bytes; /* 0: what its columns take, */
	bool text;        /* or a digit and a separator for each of them */

	/* Writes a scan: all columns in order. NULL when the format cannot be written. */
	gw_status (*write)(struct output_file *out, const scan *scan, gw_error *error);

	/* How it is written part by part, or NULL. */
	const format_parted *parted;
} format;

/* How to read a file; zeros ask the file itself. */
typedef struct format_options {
	const char *name;    /* the format to insist on, or NULL */
	const char *columns; /* names of the columns of tables without names, as "x,y,z,-,intensity":
							- leaves one out. Formats that name their columns take no notice */
	uint32_t threads;    /* 0 means one a processor */
} format_options;

#endif
