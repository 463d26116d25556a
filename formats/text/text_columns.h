/*
 * text_columns.h - which columns a table of text has, and what type each of them becomes.
 */
#ifndef TEXT_COLUMNS_H
#define TEXT_COLUMNS_H

#include "text/text_rows.h"

/* More are no point cloud, or need names. */
#define TEXT_COLUMNS_MAX 4096

typedef struct text_names {
	char **name; /* owned; count; "-" for a column that is left out */
	size_t count;
} text_names;

/* Adds a name as it is. GW_ERROR_MEMORY. */
gw_status text_names_add(text_names *names, const char *text, gw_error *error);

/* Splits a line of names. Known names become the canonical ones; quotes and the marks of a comment
 * are taken off. Ends behind one name more than TEXT_COLUMNS_MAX. GW_ERROR_MEMORY.
 *   names   on success to be given back with text_names_clear; empty on failure */
gw_status text_names_split(text_names *names, const char *line, size_t length, gw_error *error);

/*
 * Names the columns of a table by what its first rows look like.
 *   rows             of the table, before text_rows_count; sets rows->width
 *   intensity_first  with seven columns or more the fourth is the intensity, as in PTS files
 */
gw_status text_names_guess(text_names *names, text_rows *rows, bool intensity_first,
						   gw_error *error);

/* The first name but "-" that is there twice, or NULL. */
const char *text_names_repeated(const text_names *names);

/* True when x, y and z are among them. */
bool text_names_have_position(const text_names *names);

void text_names_clear(text_names *names);

/*
 * Adds a column of doubles to a scan for each name but "-".
 *   cloud    its count is set
 *   names    must live as long as *column
 *   column   receives where to read them to, names->count of them, for free(); NULL on failure
 */
gw_status text_columns_add(scan *cloud, const text_names *names, text_column **column,
						   gw_error *error);

/* Adds them and reads the rows, which have been counted, into them; then narrows them.
 *   cloud    its count is set */
gw_status text_columns_read(text_rows *rows, const text_names *names, scan *cloud, gw_error *error);

/* After reading: turns the scan's columns into the smallest types that hold all their values as
 * they were written. x, y and z stay doubles. */
gw_status text_columns_narrow(scan *cloud, const text_names *names, text_column *column,
							  gw_error *error);

#endif
