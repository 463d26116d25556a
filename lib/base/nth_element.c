#include "base/nth_element.h"

#include <stdint.h>
#include <string.h>

/* So few that putting them in order takes less than counting them in bins. */
#define FEW 64

static uint32_t bits_of(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

static float of_bits(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static float nth_of_few(const float *values, size_t count, size_t rank)
{
	uint32_t sorted[FEW];
	for (size_t i = 0; i < count; i++) {
		uint32_t bits = bits_of(values[i]);
		size_t place = i;
		for (; place > 0 && sorted[place - 1] > bits; place--)
			sorted[place] = sorted[place - 1];
		sorted[place] = bits;
	}
	return of_bits(sorted[rank]);
}

/* Two counting passes over the float's bits, which order non-negative floats as integers. */
float gw_nth_element(const float *values, size_t count, size_t rank)
{
	if (count <= FEW)
		return nth_of_few(values, count, rank);
	uint32_t high = 0, bits = 0;
	for (int pass = 0; pass < 2; pass++) {
		uint32_t in_bin[1u << 16] = { 0 };
		for (size_t i = 0; i < count; i++) {
			bits = bits_of(values[i]);
			if (pass == 0)
				in_bin[bits >> 16]++;
			else if (bits >> 16 == high)
				in_bin[bits & 0xffff]++;
		}
		uint32_t bin = 0;
		for (; bin < 0xffff && rank >= in_bin[bin]; bin++)
			rank -= in_bin[bin];
		bits = high << 16 | bin;
		high = bin;
	}
	return of_bits(bits);
}
