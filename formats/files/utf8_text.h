/*
 * utf8_text.h - characters of texts that anybody may have written, in whatever encoding.
 */
#ifndef UTF8_TEXT_H
#define UTF8_TEXT_H

#include <stddef.h>

/* Bytes of the UTF-8 character at the start of a text that ends in a zero; 0 when it is none
 * (RFC 3629). */
size_t utf8_length(const unsigned char *text);

#endif
