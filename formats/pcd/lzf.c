#include "pcd/lzf.h"

#include <string.h>

/* One step of a stream: bytes to take from it, or to repeat from `distance` bytes before. */
typedef struct step {
	size_t size;
	size_t distance; /* 0: literal bytes */
} step;

/* Reads a step's head; false when the stream ends in it. */
static bool take_step(const uint8_t **at, const uint8_t *end, step *s)
{
	size_t control = *(*at)++;
	if (control < 32) {
		*s = (step){ control + 1, 0 };
		return (size_t)(end - *at) >= s->size;
	}
	size_t size = control >> 5;
	if (size == 7) {
		if (*at == end)
			return false;
		size += *(*at)++;
	}
	if (*at == end)
		return false;
	*s = (step){ size + 2, ((control & 31) << 8 | *(*at)++) + 1 };
	return true;
}

bool lzf_measure(const uint8_t *packed, size_t length, size_t most, size_t *unpacked)
{
	const uint8_t *at = packed, *end = packed + length;
	step s;
	*unpacked = 0;
	while (at < end) {
		if (!take_step(&at, end, &s) || s.distance > *unpacked || s.size > most - *unpacked)
			return false;
		at += s.distance ? 0 : s.size;
		*unpacked += s.size;
	}
	return true;
}

void lzf_unpack(const uint8_t *packed, size_t length, uint8_t *out)
{
	const uint8_t *at = packed, *end = packed + length;
	step s;
	while (at < end && take_step(&at, end, &s)) {
		if (s.distance == 0) {
			memcpy(out, at, s.size);
			at += s.size;
		} else if (s.distance >= s.size) {
			memcpy(out, out - s.distance, s.size);
		} else { /* what is repeated grows while it is read */
			const uint8_t *from = out - s.distance;
			for (size_t i = 0; i < s.size; i++)
				out[i] = from[i];
		}
		out += s.size;
	}
}
