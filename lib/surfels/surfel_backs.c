/* surfel_backs.c - see surfel_backs.h. */
#include "surfels/surfel_backs.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static size_t count_of(const gw_surfels *s, uint8_t side)
{
	size_t count = 0;
	for (size_t i = 0; i < s->count; i++)
		count += s->two_sided[i] == side;
	return count;
}

/* Makes room for `more` rows behind an array, which hold what the unclear surfels have. */
static bool repeat(const gw_surfels *s, const uint8_t *side, size_t more, size_t row, void *array)
{
	void **to = array;
	char *grown = *to ? gw_resize_array(*to, s->count + more, row) : NULL;
	if (!*to || !grown)
		return !*to;
	*to = grown;
	char *end = grown + s->count * row;
	for (size_t i = 0; i < s->count; i++)
		if (side[i] == GW_SIDE_UNCLEAR) {
			memcpy(end, grown + i * row, row);
			end += row;
		}
	return true;
}

static bool repeat_all(gw_surfels *s, const uint8_t *side, size_t more)
{
	const struct {
		void *array;
		size_t row;
	} rows[] = {
		{ &s->position, 12 },     { &s->normal, 12 },   { &s->shading_normal, 12 },
		{ &s->normal_length, 4 }, { &s->albedo, 12 },   { &s->shading_normal_off, 4 },
		{ &s->emission, 12 },     { &s->nearest, 4 },   { &s->radius, 4 },
		{ &s->area, 4 },          { &s->clip, 24 },     { &s->bend, 12 },
		{ &s->creased, 1 },       { &s->two_sided, 1 }, { &s->noise, 4 },
		{ &s->transparency, 4 },  { &s->doubt, 4 },
	};
	bool good = true;
	for (size_t i = 0; i < sizeof rows / sizeof *rows && good; i++)
		good = repeat(s, side, more, rows[i].row, rows[i].array);
	return good;
}

/* The tangents of one side in the frame of the other: columns are the old ones. */
static void find_turn(const float from[3], const float to[3], float turn[2][2])
{
	float old[2][3], new[2][3];
	gw_tangent_frame(from, old[0], old[1]);
	gw_tangent_frame(to, new[0], new[1]);
	for (int r = 0; r < 2; r++)
		for (int c = 0; c < 2; c++)
			turn[r][c] = new[r][0] * old[c][0] + new[r][1] * old[c][1] + new[r][2] * old[c][2];
}

/* What lay above the disc lies below it; cuts and bend get other coordinates, but no other place.
 */
static void turn_round(gw_surfels *s, size_t i)
{
	float *normal = s->normal + 3 * i, *clip = s->clip + 6 * i, q[2][2];
	const float from[3] = { normal[0], normal[1], normal[2] };
	for (size_t k = 0; k < 3; k++) {
		normal[k] = -normal[k];
		if (s->shading_normal)
			s->shading_normal[3 * i + k] = -s->shading_normal[3 * i + k];
	}
	find_turn(from, normal, q);
	for (size_t c = 0; c < 6; c += 3) {
		float x = clip[c], y = clip[c + 1];
		clip[c] = q[0][0] * x + q[0][1] * y;
		clip[c + 1] = q[1][0] * x + q[1][1] * y;
	}
	float *b = s->bend ? s->bend + 3 * i : NULL;
	if (!b)
		return;
	const float m[3] = { b[0], b[1], b[2] };
	for (int e = 0; e < 3; e++) {
		const float *r = q[e == 2], *c = q[e > 0];
		b[e] = -(r[0] * (m[0] * c[0] + m[1] * c[1]) + r[1] * (m[1] * c[0] + m[2] * c[1]));
	}
}

gw_status gw_surfel_backs_add(gw_surfels *s, gw_error *error)
{
	size_t more = count_of(s, GW_SIDE_UNCLEAR);
	if (more == 0)
		return GW_OK;
	uint8_t *side = gw_allocate_array(s->count, sizeof *side);
	if (side)
		memcpy(side, s->two_sided, s->count);
	bool good = side && repeat_all(s, side, more);
	free(side);
	if (!good)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for both sides of %zu points", more);
	for (size_t i = s->count; i < s->count + more; i++) {
		s->two_sided[i] = GW_SIDE_BACK;
		turn_round(s, i);
	}
	s->count += more;
	return GW_OK;
}

gw_status gw_surfel_backs_find(const gw_surfels *s, uint32_t **back, gw_error *error)
{
	*back = NULL;
	if (count_of(s, GW_SIDE_BACK) == 0)
		return GW_OK;
	*back = gw_allocate_array(s->count, sizeof **back);
	if (!*back)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the backs of %zu surfels", s->count);
	size_t at = 0;
	for (size_t i = 0; i < s->count; i++) {
		(*back)[i] = UINT32_MAX;
		if (s->two_sided[i] != GW_SIDE_UNCLEAR)
			continue;
		while (at < s->count && s->two_sided[at] != GW_SIDE_BACK)
			at++;
		if (at < s->count)
			(*back)[i] = (uint32_t)at++;
	}
	return GW_OK;
}
