/*
 * format.h - file formats. Each format is one file that exports one const struct; the table of
 * them (format.c) is all that the program knows about formats.
 */
#ifndef FORMAT_H
#define FORMAT_H

#include "scan.h"

struct output_file; /* output_file.h: temporary name, checked writes, renamed when whole */
struct input_file;  /* input_file.h: a file or standard input as bytes in memory, with its length */

typedef struct format {
	const char *name;              /* "ply", as on the command line */
	const char *description;       /* for --help, a few words */
	const char *const *extensions; /* NULL-terminated, lower case without the dot */

	/* True when the first `length` bytes of a file look like this format, of which at least the
	 * first 4096 are given if the file has them. NULL: by extension only. */
	bool (*probe)(const uint8_t *head, size_t length);
	bool unspecific; /* probe also takes others' files: an extension that is known goes before it */

	/* Reads a whole scan. On failure *scan is empty. NULL when the format cannot be read. Every
	 * count is checked against the bytes that are there before anything is allocated. */
	gw_status (*read)(struct input_file *in, scan *scan, gw_error *error);

	/* Whether the format can hold the coordinates of a scan; NULL: those of any.
	 *   name   of the file, for messages */
	gw_status (*accept)(const scan *scan, const char *name, gw_error *error);

	/* What a point takes at least when it is written. */
	size_t row_bytes; /* 0: what its columns take, */
	bool text;        /* or a digit and a separator for each of them */

	/* Writes a scan: all columns in order. NULL when the format cannot be written. */
	gw_status (*write)(struct output_file *out, const scan *scan, gw_error *error);
} format;

extern const format *const formats[]; /* NULL-terminated */

/* The format called `name`, or the one whose extension `path` has; NULL when there is none. */
const format *format_by_name(const char *name);
const format *format_by_path(const char *path);

/* How to read a file; zeros ask the file itself. */
typedef struct format_options {
	const char *name;    /* the format to insist on, or NULL */
	const char *columns; /* names of the columns of tables without names, as "x,y,z,-,intensity":
							- leaves one out. Formats that name their columns take no notice */
	uint32_t threads;    /* 0 means one a processor */
} format_options;

/*
 * Reads a scan from a file, format found by content, then by extension.
 *   path     "-" is standard input
 *   options  NULL: all zeros
 *   found    receives the format that it was; may be NULL
 */
gw_status format_read_with(const char *path, const format_options *options, scan *scan,
						   const format **found, gw_error *error);

/* The same with nothing but the name of the format to insist on, or NULL. */
gw_status format_read(const char *path, const char *name, scan *scan, gw_error *error);
gw_status format_read_found(const char *path, const char *name, scan *scan, const format **found,
							gw_error *error);

#endif
