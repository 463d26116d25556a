/*
 * number_text.h - numbers to text and back, the same in every locale.
 *
 * A number is written with digits and a decimal point whatever the user's language is, and reading
 * back what was printed gives the same bits.
 */
#ifndef NUMBER_TEXT_H
#define NUMBER_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Room for any number as text, with the final zero. */
#define NUMBER_TEXT 32

/*
 * Reads the decimal number at the start of a text: sign, digits, point, exponent; or inf, infinity,
 * nan, and Microsoft's 1.#INF and 1.#QNAN, in any case. Correctly rounded.
 *
 *   text    need not end in a zero; no byte from text + length on is read
 *   value   receives the number; too large ones become infinite, too small ones zero
 *
 * Returns how many bytes belong to the number, or 0 when the text does not start with one. White
 * space in front is not skipped.
 */
size_t number_read(const char *text, size_t length, double *value);

/* How a number was written. */
typedef struct number_form {
	bool whole;  /* an integer without point, exponent or a sign before zero */
	bool single; /* printed again from single precision it would be the same number */
} number_form;

/* As number_read, and says how it was written. */
size_t number_read_form(const char *text, size_t length, double *value, number_form *form);

/* The same, rounded once to single precision (a detour over double would round twice). */
size_t number_read_float(const char *text, size_t length, float *value);

/* Writes the shortest text that reads back as the same bits (any NaN as "nan") and a final zero.
 * Returns its length. text: NUMBER_TEXT bytes. */
size_t number_print(char *text, double value);
size_t number_print_float(char *text, float value);

#endif
