#include "files/checksum.h"

#include <string.h>

/* Two steps of the finalizer of splitmix64 (Steele and others 2014), of which the factors are. */
static uint64_t mix(uint64_t state, uint64_t word)
{
	uint64_t z = (state ^ word) * UINT64_C(0xbf58476d1ce4e5b9);
	return z ^ z >> 29;
}

void checksum_add(checksum *sum, const void *bytes, size_t length)
{
	const uint8_t *at = bytes, *end = at + length;
	for (; at < end && sum->length % 8 != 0; at++) {
		sum->rest |= (uint64_t)*at << 8 * (sum->length % 8);
		if (++sum->length % 8 == 0) {
			sum->state = mix(sum->state, sum->rest);
			sum->rest = 0;
		}
	}
	for (; end - at >= 8; at += 8, sum->length += 8) {
		uint64_t word;
		memcpy(&word, at, 8);
		sum->state = mix(sum->state, word);
	}
	for (; at < end; at++)
		sum->rest |= (uint64_t)*at << 8 * (sum->length++ % 8);
}

uint64_t checksum_value(const checksum *sum)
{
	uint64_t z = mix(mix(sum->state, sum->rest), sum->length + 1);
	z *= UINT64_C(0x94d049bb133111eb);
	z ^= z >> 31;
	return z ? z : 1;
}
