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

#endif
