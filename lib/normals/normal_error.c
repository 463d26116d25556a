/*
 * normal_error.c - see normal_error.h.
 */
#include "normals/normal_error.h"

#include "base/luminance.h"

#include <math.h>
#include <string.h>

/* A normal that is off by less, radians, is off because of noise. */
#define LEAST 0.02

/* Whose normal a surfel may share: it is so near, in radii; so much higher than the other's plane
 * at most, over its distance; and the normals differ by so much at least. Then the surface does not
 * just bend. */
#define NEAR_RADII 2.0
#define IN_PLANE 0.1
#define BEND 0.3

#define REACH 32u /* surfels before and after one in Morton order */
#define SEED 0x632be5abu

/* In [0, 1), by SplitMix64 (Steele, Lea and Flood 2014). */
static double random_of(uint64_t seed)
{
	uint64_t z = (seed + 1) * 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static void turn_anywhere(const float normal[3], float angle, uint64_t seed, float turned[3])
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

static const float *lit_normal(const gw_surfels *s, size_t i)
{
	return (s->shading_normal ? s->shading_normal : s->normal) + 3 * i;
}

/* Squared difference of two normals where the first surfel lies in the plane of the other, nearby,
 * and that is more than what a bend of the surface makes of it; else 0. */
static double may_share(const gw_surfels *s, size_t i, size_t j)
{
	const float *p = s->position + 3 * i, *q = s->position + 3 * j;
	const float *n = lit_normal(s, i), *m = lit_normal(s, j);
	double height = 0, apart = 0, squared = 0, reach = NEAR_RADII * (double)s->radius[i];
	for (size_t k = 0; k < 3; k++) {
		double d = (double)p[k] - (double)q[k], turn = (double)n[k] - (double)m[k];
		height += (double)m[k] * d;
		apart += d * d;
		squared += turn * turn;
	}
	bool in_plane = height * height < IN_PLANE * IN_PLANE * apart;
	return in_plane && apart < reach * reach && squared > BEND * BEND ? squared : 0;
}

/* One of the surfels whose normal this one may share, drawn by chance; GW_NONE: there is none.
 * Those nearby are next to it in Morton order, or most of them. */
static size_t draw_other(const gw_surfels *s, size_t i, double *squared)
{
	size_t first = i > REACH ? i - REACH : 0, last = i + REACH < s->count ? i + REACH : s->count;
	size_t found = SIZE_MAX;
	uint32_t count = 0;
	for (size_t j = first; j < last; j++) {
		double differs = j != i ? may_share(s, i, j) : 0;
		if (differs > 0 && random_of(SEED * i + j) * ++count < 1) {
			found = j;
			*squared = differs;
		}
	}
	return found;
}

void gw_normal_turn(const gw_surfels *s, size_t i, float turned[3])
{
	const float *own = lit_normal(s, i);
	double off = (double)s->shading_normal_off[i], squared = 0;
	size_t other = off > LEAST ? draw_other(s, i, &squared) : SIZE_MAX;
	if (other == SIZE_MAX) {
		turn_anywhere(own, (float)off, i, turned);
		return;
	}
	bool turns = random_of(i) * squared < off * off;
	memcpy(turned, turns ? lit_normal(s, other) : own, 3 * sizeof *turned);
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
