/* random_numbers.h - random numbers that are the same on every machine. */
#ifndef RANDOM_NUMBERS_H
#define RANDOM_NUMBERS_H

#include <math.h>
#include <stdint.h>

/* Evenly from 0 to below 1, by SplitMix64 (Steele et al. 2014). */
static inline double random_number(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Standard normal, by Box and Muller. */
static inline double random_normal(uint64_t *state)
{
	double radius = sqrt(-2.0 * log(1.0 - random_number(state)));
	return radius * cos(2.0 * M_PI * random_number(state));
}

#endif
