/*
 * number_chars.h - numbers to text and back by C++'s charconv, which knows no locale and rounds
 * once. number_text.h has the quick ways for what most files hold, and calls this for the rest.
 */
#ifndef NUMBER_CHARS_H
#define NUMBER_CHARS_H

#include "files/number_text.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The value of a text that is a decimal number and nothing else: an optional sign, digits with or
 * without a point, an optional exponent. Too large ones become infinite, too small ones zero. */
double number_from_chars(const char *text, size_t length);
float number_float_from_chars(const char *text, size_t length);

/* The shortest text that reads back as the same bits, any NaN as "nan", and a final zero; without
 * exponent for sizes from 1e-4 to below 1e15, or 1e6 of single precision, and with one from 1e15
 * on. Returns its length.
 * text: NUMBER_TEXT bytes. */
size_t number_to_chars(char *text, double value);
size_t number_float_to_chars(char *text, float value);

#ifdef __cplusplus
}
#endif

#endif
