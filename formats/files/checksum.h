/*
 * checksum.h - a number by which bytes are told from what a torn write or a bad disk makes of them;
 * not from what somebody forges.
 */
#ifndef CHECKSUM_H
#define CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

/* Of bytes that come piece by piece; zeros are the beginning. How they are cut does not matter. */
typedef struct checksum {
	uint64_t state, length;
	uint64_t rest; /* of the last length % 8 bytes */
} checksum;

void checksum_add(checksum *sum, const void *bytes, size_t length);

/* Of all bytes so far; more may be added. Never 0. */
uint64_t checksum_value(const checksum *sum);

#endif
