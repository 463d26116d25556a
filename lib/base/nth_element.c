#include "base/nth_element.h"

#include <stdint.h>
#include <string.h>

/* Two counting passes over the float's bits, which order non-negative floats as integers. */
float gw_nth_element(const float *values, size_t count, size_t rank)
{
	uint32_t high = 0, bits;
	for (int pass = 0; pass < 2; pass++) {
		uint32_t in_bin[1u << 16] = { 0 };
		for (size_t i = 0; i < count; i++) {
			memcpy(&bits, values + i, sizeof bits);
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
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}
