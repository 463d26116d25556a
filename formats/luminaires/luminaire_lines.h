/*
 * luminaire_lines.h - lines and numbers of files of luminaires.
 */
#ifndef LUMINAIRE_LINES_H
#define LUMINAIRE_LINES_H

#include "luminaires/luminaire.h"

/* Where in a file the reading is. */
typedef struct luminaire_lines {
	const input_file *in;
	size_t at;   /* of the next byte */
	size_t line; /* the number of the line that it is in, from 1 */
	gw_error *error;
} luminaire_lines;

luminaire_lines luminaire_lines_of(const input_file *in, gw_error *error);

/* Whether a line begins with TILT=. */
bool luminaire_lines_tilt(const input_file *in);

/* Takes the rest of the line, whatever ends it, without blanks around it; false at the end of the
 * file. text: LUMINAIRE_TEXT bytes, receives as much of it as fits, as UTF-8 without control
 * characters (what is not UTF-8 is taken for Latin-1). */
bool luminaire_lines_next(luminaire_lines *lines, char *text);

/* Takes a number, of which blanks, commas and ends of lines keep the next apart. what: for the
 * message, such as "a vertical angle". GW_ERROR_DATA when there is none, or it is not finite. */
gw_status luminaire_lines_number(luminaire_lines *lines, const char *what, double *value);

/* The same, which must be whole and from least to most. */
gw_status luminaire_lines_count(luminaire_lines *lines, const char *what, double least, double most,
								size_t *count);

/* The number that a whole line has; a comma may stand for its point. */
gw_status luminaire_lines_value(luminaire_lines *lines, const char *what, double *value);

/* So many numbers, one after the other by a function such as those two; *values is the caller's,
 * for free(). Counts that are more than the bytes that are left could hold fail before anything is
 * allocated. */
typedef gw_status luminaire_lines_take(luminaire_lines *lines, const char *what, double *value);
gw_status luminaire_lines_numbers(luminaire_lines *lines, luminaire_lines_take *take,
								  const char *what, size_t count, double **values);

/* Fails with the file, the line and a sentence. */
gw_status luminaire_lines_fail(const luminaire_lines *lines, const char *form, ...)
	__attribute__((format(printf, 2, 3)));

#endif
