/*
 * text_quote.h - text for others to read: words for a shell, strings for JSON.
 */
#ifndef TEXT_QUOTE_H
#define TEXT_QUOTE_H

#include <stdio.h>

/* Writes a word as a shell takes it: as it is, or in single quotes. */
void text_quote(FILE *out, const char *word);

/* Writes a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD. */
void text_quote_json(FILE *out, const char *text);

/*
 * Writes a message as printf does, but for what a terminal would obey: control characters, which
 * names of files may hold, and bytes that are no UTF-8 become \x1b and the like. Only a line end at
 * the very end stays.
 */
void text_message(FILE *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A share as percent with two digits, never with an exponent: "0.0031", "13", "990". */
#define TEXT_PERCENT 32
const char *text_percent(double share, char text[TEXT_PERCENT]);

#endif
