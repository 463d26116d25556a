/*
 * hash.c - see hash.h. Four sums run side by side, because one alone would wait for its
 * multiplications; the multipliers are primes near 2^64 divided by the golden ratio and the like.
 */
#include "base/hash.h"

#include <string.h>

#define LANES 4

static const uint64_t prime[LANES] = { UINT64_C(0x9e3779b185ebca87), UINT64_C(0xc2b2ae3d27d4eb4f),
									   UINT64_C(0x165667b19e3779f9), UINT64_C(0x27d4eb2f165667c5) };

static uint64_t turn(uint64_t x)
{
	return x << 31 | x >> 33;
}

static uint64_t mix(uint64_t x)
{
	x = (x ^ x >> 32) * prime[0];
	x = (x ^ x >> 29) * prime[1];
	return x ^ x >> 32;
}

uint64_t gw_hash(uint64_t state, const void *bytes, size_t length)
{
	const unsigned char *at = bytes;
	uint64_t lane[LANES], word[LANES];
	for (int k = 0; k < LANES; k++)
		lane[k] = state + prime[k];
	size_t left = length;
	for (; left >= sizeof word; left -= sizeof word, at += sizeof word) {
		memcpy(word, at, sizeof word);
		for (int k = 0; k < LANES; k++)
			lane[k] = turn(lane[k] ^ word[k] * prime[1]) * prime[0];
	}
	memset(word, 0, sizeof word);
	if (left > 0)
		memcpy(word, at, left);
	uint64_t hash = mix(state ^ (uint64_t)length);
	for (int k = 0; k < LANES; k++)
		hash = mix(hash * prime[2] + (turn(lane[k] ^ word[k] * prime[1]) * prime[0]));
	return hash;
}
