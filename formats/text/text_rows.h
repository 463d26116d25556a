/*
 * text_rows.h - rows of numbers as text, one a line, into columns; on all threads.
 *
 * Two passes: the first counts rows, so that columns are allocated once and at their size; the
 * second reads numbers. Blank lines and lines that begin with # or // are no rows. Values are
 * parted by blanks, or by one separator with blanks around it; between two separators may be
 * nothing, which is NaN. Quotes around values count as blanks.
 */
#ifndef TEXT_ROWS_H
#define TEXT_ROWS_H

#include "files/input_file.h"
#include "files/number_text.h"
#include "points/scan.h"

#include <stdatomic.h>

/* Which lines besides blank ones and comments are left out. */
typedef enum text_rows_skip {
	TEXT_ROWS_SKIP_NOTHING,
	TEXT_ROWS_SKIP_ORIGIN, /* rows whose first three values are zero: a scanner's empty cells */
	TEXT_ROWS_SKIP_SINGLE, /* rows of one value: the counts in PTS files */
	TEXT_ROWS_SKIP_LONG,   /* rows of more values than `width` */
} text_rows_skip;

/* A stretch of text as the first pass left it. */
typedef struct text_chunk {
	size_t begin;   /* offset of its first line from text_rows.begin */
	size_t row;     /* rows before it */
	size_t line;    /* lines before it */
	size_t cell;    /* rows before it and those that are left out */
	size_t skipped; /* rows in it that are left out */
} text_chunk;

typedef struct text_rows {
	const input_file *in;    /* for messages and the number of threads */
	const char *begin, *end; /* of the text */
	size_t first_line;       /* of the file, the number of the line at begin; the first is 1 */
	char newline;            /* '\n', or '\r' in files that have no other */
	char separator;          /* ',' or ';', or ' ' for none but blanks */
	size_t width;            /* values in a row, at least 1 */
	bool open;               /* rows may have more values; those are left out */
	text_rows_skip skip;

	/* What text_rows_count finds. */
	size_t count;      /* rows */
	size_t skipped;    /* rows left out by `skip` */
	text_chunk *chunk; /* owned; chunk_count + 1 */
	size_t chunk_count;

	uint32_t *cell; /* NULL, or receives in the second pass how many rows, those left out included,
					   are before each row; count */
} text_rows;

/* Where the values of one column go. */
typedef struct text_column {
	const char *name; /* for messages */
	scan_type type;
	void *data; /* text_rows.count values of the type; NULL: the values are left out */
	/* What is true of all values read so far; only kept for SCAN_FLOAT64. Begin with true. */
	atomic_bool whole, single; /* as in number_form */
} text_column;

/*
 * First pass: counts the rows.
 *   rows    its first part filled; on success to be given back with text_rows_clear
 */
gw_status text_rows_count(text_rows *rows, gw_error *error);

/*
 * Second pass: reads the rows.
 *   column   rows->width of them
 *   error    GW_ERROR_DATA with file, line and value
 */
gw_status text_rows_read(const text_rows *rows, text_column *column, gw_error *error);

void text_rows_clear(text_rows *rows);

/* ------------------------------------------------------------------------- what readers share */

/* The text of a file; the mark that some programs put before UTF-8 is left out. */
const char *text_rows_begin(const uint8_t *data, size_t length);

/* '\r' for a text that ends its first lines with nothing else, '\n' for all others. */
char text_rows_newline(const char *text, const char *end);

/* The separator that a line has: ';' before ',' before blanks. */
char text_rows_separator(const char *line, size_t length);

/* The next line and its length without its end; *at moves behind it. False at the end of the text.
 */
bool text_rows_next_line(const char **at, const char *end, char newline, const char **line,
						 size_t *length);

/* The first line of a text that is a row; false when there is none. */
bool text_rows_first(const text_rows *rows, const char **line, size_t *length);

/* True when the line is blank or a comment. */
bool text_rows_is_empty(const char *line, size_t length);

/* The most numbers of a line that are asked for. */
#define TEXT_ROWS_NUMBERS 64

/* Splits a line into at most `most` numbers, of TEXT_ROWS_NUMBERS; returns how many, or 0 when a
 * word is no number or there are more. */
size_t text_rows_numbers(const char *line, size_t length, char separator, double *value,
						 size_t most);

/* The same, and how each was written. */
size_t text_rows_forms(const char *line, size_t length, char separator, double *value,
					   number_form *form, size_t most);

#endif
