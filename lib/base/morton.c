/* morton.c - Morton keys on the CPU; see glowworm_picture.h. */
#include "glowworm_picture.h"

static const uint64_t mask[] = {
	0x1fffff,           0x1f00000000ffff,   0x1f0000ff0000ff,
	0x100f00f00f00f00f, 0x10c30c30c30c30c3, 0x1249249249249249,
};

/* Bit i goes to bit 3 i. */
static uint64_t spread(uint32_t value)
{
	uint64_t v = value & mask[0];
	for (uint32_t i = 1, shift = 32; i < 6; i++, shift /= 2)
		v = (v | v << shift) & mask[i];
	return v;
}

static uint32_t gather(uint64_t v)
{
	v &= mask[5];
	for (uint32_t i = 5, shift = 2; i-- > 0; shift *= 2)
		v = (v | v >> shift) & mask[i];
	return (uint32_t)v;
}

uint64_t gw_morton_encode(uint32_t x, uint32_t y, uint32_t z)
{
	return spread(x) | spread(y) << 1 | spread(z) << 2;
}

void gw_morton_decode(uint64_t key, uint32_t cell[3])
{
	for (uint32_t k = 0; k < 3; k++)
		cell[k] = gather(key >> k);
}
