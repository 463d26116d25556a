/*
 * octahedral.c - see octahedral.h.
 */
#include "light/octahedral.h"

#include <stdbool.h>
#include <stddef.h>

static float sign_of(float value)
{
	return value < 0.0f ? -1.0f : 1.0f;
}

gw_vec3 gw_octahedral_direction(float u, float v)
{
	gw_vec3 d = { u, v, 1.0f - fabsf(u) - fabsf(v) };
	if (d.z < 0.0f) {
		d.x = (1.0f - fabsf(v)) * sign_of(u);
		d.y = (1.0f - fabsf(u)) * sign_of(v);
	}
	return gw_unit(d);
}

void gw_octahedral_place(gw_vec3 direction, float *u, float *v)
{
	gw_vec3 d =
		gw_times(direction, 1.0f / (fabsf(direction.x) + fabsf(direction.y) + fabsf(direction.z)));
	*u = d.z < 0.0f ? (1.0f - fabsf(d.y)) * sign_of(d.x) : d.x;
	*v = d.z < 0.0f ? (1.0f - fabsf(d.x)) * sign_of(d.y) : d.y;
}

gw_vec3 gw_octahedral_texel(uint32_t size, uint32_t texel)
{
	float step = 2.0f / (float)size;
	return gw_octahedral_direction(((float)(texel % size) + 0.5f) * step - 1.0f,
								   ((float)(texel / size) + 0.5f) * step - 1.0f);
}

/* The solid angle of the triangle between three unit vectors (van Oosterom and Strackee 1983). */
static double solid_angle(gw_vec3 a, gw_vec3 b, gw_vec3 c)
{
	double volume = (double)a.x * ((double)b.y * (double)c.z - (double)b.z * (double)c.y) +
					(double)a.y * ((double)b.z * (double)c.x - (double)b.x * (double)c.z) +
					(double)a.z * ((double)b.x * (double)c.y - (double)b.y * (double)c.x);
	double rest = 1.0 + (double)gw_dot(a, b) + (double)gw_dot(b, c) + (double)gw_dot(c, a);
	return 2.0 * atan2(fabs(volume), rest);
}

double gw_octahedral_solid_angle(uint32_t size, uint32_t texel)
{
	uint32_t column = texel % size, row = texel / size;
	float step = 2.0f / (float)size;
	gw_vec3 corner[4]; /* bit 0: right, bit 1: below */
	for (uint32_t i = 0; i < 4; i++)
		corner[i] = gw_octahedral_direction((float)(column + (i & 1)) * step - 1.0f,
											(float)(row + (i >> 1)) * step - 1.0f);
	/* Cut along the diagonal that the fold of its quarter runs along. */
	bool falling = (2 * column < size) != (2 * row < size);
	gw_vec3 one = corner[falling ? 0 : 1], other = corner[falling ? 3 : 2];
	return solid_angle(one, other, corner[falling ? 1 : 0]) +
		   solid_angle(one, other, corner[falling ? 2 : 3]);
}

uint32_t gw_octahedral_beside(uint32_t size, uint32_t texel, uint32_t side)
{
	const uint32_t last = size - 1, column = texel % size, row = texel / size;
	const bool across = side < 2, on = (side & 1) != 0;
	const uint32_t along = across ? column : row;
	if (along == (on ? last : 0))
		return across ? (last - row) * size + column : row * size + last - column;
	const uint32_t step = across ? 1 : size;
	return on ? texel + step : texel - step;
}

uint64_t gw_octahedral_mip_texels(uint32_t size)
{
	return ((uint64_t)size * size - 1) / 3;
}

/* One map of half the size from the one before it. */
static void halve(uint32_t size, const float *from, float *to, float (*choose)(float, float))
{
	uint32_t half = size / 2;
	for (uint32_t row = 0; row < half; row++)
		for (uint32_t column = 0; column < half; column++) {
			const float *above = from + 2 * (size_t)row * size + 2 * (size_t)column;
			const float *below = above + size;
			to[(size_t)row * half + column] =
				choose(choose(above[0], above[1]), choose(below[0], below[1]));
		}
}

void gw_octahedral_mips(uint32_t size, const float *value, float *least, float *most)
{
	const float *least_from = value, *most_from = value;
	for (; size > 1; size /= 2) {
		halve(size, least_from, least, gw_smaller);
		halve(size, most_from, most, gw_larger);
		least_from = least;
		most_from = most;
		least += (size_t)(size / 2) * (size / 2);
		most += (size_t)(size / 2) * (size / 2);
	}
}
