/*
 * little_endian.h - numbers in bytes, lowest byte first, on any machine and at any address.
 */
#ifndef LITTLE_ENDIAN_H
#define LITTLE_ENDIAN_H

#include <stdint.h>
#include <string.h>

static inline uint16_t load_16(const uint8_t *from)
{
	return (uint16_t)(from[0] | from[1] << 8);
}

static inline uint32_t load_32(const uint8_t *from)
{
	return (uint32_t)load_16(from) | (uint32_t)load_16(from + 2) << 16;
}

static inline uint64_t load_64(const uint8_t *from)
{
	return (uint64_t)load_32(from) | (uint64_t)load_32(from + 4) << 32;
}

static inline double load_double(const uint8_t *from)
{
	uint64_t bits = load_64(from);
	double value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline void store_16(uint8_t *to, uint16_t value)
{
	to[0] = (uint8_t)value;
	to[1] = (uint8_t)(value >> 8);
}

static inline void store_32(uint8_t *to, uint32_t value)
{
	store_16(to, (uint16_t)value);
	store_16(to + 2, (uint16_t)(value >> 16));
}

static inline void store_64(uint8_t *to, uint64_t value)
{
	store_32(to, (uint32_t)value);
	store_32(to + 4, (uint32_t)(value >> 32));
}

static inline void store_double(uint8_t *to, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	store_64(to, bits);
}

/* A number of this machine as it lies in memory, whatever its type. */
static inline void store_value(uint8_t *to, const uint8_t *from, size_t size)
{
	if (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__) {
		memcpy(to, from, size);
		return;
	}
	for (size_t b = 0; b < size; b++)
		to[b] = from[size - 1 - b];
}

#endif
