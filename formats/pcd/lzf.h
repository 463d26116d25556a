/*
 * lzf.h - the compression of PCD files, LZF: a byte below 32 and then one more than that many
 * literal bytes, or a length in its upper 3 bits (7: another byte adds to it) and a distance in the
 * other 5 and the next byte, for bytes that came before.
 */
#ifndef LZF_H
#define LZF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes that a stream unpacks to, found without unpacking it. False when it is damaged: cut short,
 * reaching before its start, or longer than `most`. Thread-safe, as is the next. */
bool lzf_measure(const uint8_t *packed, size_t length, size_t most, size_t *unpacked);

/* Unpacks a stream that lzf_measure has found to be good. out: as many bytes as that found. */
void lzf_unpack(const uint8_t *packed, size_t length, uint8_t *out);

#endif
