/*
 * normal_error.c - see normal_error.h.
 */
#include "normals/normal_error.h"

#include "base/luminance.h"

#include <math.h>

/* In [0, 1), by SplitMix64 (Steele, Lea and Flood 2014). */
static double random_of(uint64_t seed)
{
	uint64_t z = (seed + 1) * 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

void gw_normal_turn(const float normal[3], float angle, uint64_t seed, float turned[3])
{
	double direction = 2 * M_PI * random_of(seed);
	double along = cos((double)angle), x = sin((double)angle) * cos(direction),
		   y = sin((double)angle) * sin(direction);
	float tangent[3], bitangent[3];
	gw_tangent_frame(normal, tangent, bitangent);
	for (size_t k = 0; k < 3; k++)
		turned[k] =
			(float)(along * (double)normal[k] + x * (double)tangent[k] + y * (double)bitangent[k]);
}

double gw_normal_error(const gw_surfels *surfels, const float *direct, const float *turned,
					   const bool *counts)
{
	double sum = 0;
	size_t used = 0;
	for (size_t i = 0; i < surfels->count; i++) {
		float change[3];
		if (!counts[i])
			continue;
		for (size_t k = 0; k < 3; k++)
			change[k] = surfels->albedo[3 * i + k] * (turned[4 * i + k] - direct[4 * i + k]);
		double off = gw_luminance(change) / M_PI;
		sum += off * off;
		used++;
	}
	return used ? sum / (double)used : 0;
}
