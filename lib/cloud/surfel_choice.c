/* surfel_choice.c - leaves the surfels that are asked for. */
#include "cloud/surfel_choice.h"

#include "base/memory.h"
#include "base/nth_element.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEVEL 8       /* 2^8 cells along the longest side of the bounds, at most */
#define IN_A_CELL 8.0 /* points on average, at least */
#define DISC_POINTS 8 /* that a disc reaches over, as in surfel_disc.c */

/* One size of cells over the bounds. */
typedef struct cells {
	const gw_surfels *surfels;
	double per_metre;
} cells;

static void cell_of(const cells *c, size_t surfel, int32_t cell[3])
{
	const gw_surfels *s = c->surfels;
	for (size_t k = 0; k < 3; k++)
		cell[k] =
			(int32_t)(((double)s->position[3 * surfel + k] - (double)s->minimum[k]) * c->per_metre);
}

/* Surfels lie in Morton order, so those of a cell are next to each other: where they end. */
static size_t end_of_cell(const cells *c, size_t first)
{
	int32_t cell[3], next[3];
	size_t last = first + 1;
	cell_of(c, first, cell);
	for (; last < c->surfels->count; last++) {
		cell_of(c, last, next);
		if (memcmp(cell, next, sizeof cell) != 0)
			break;
	}
	return last;
}

/* The finest cells that hold enough points. Their width is a power of two of the Morton grid's. */
static cells choose_cells(const gw_surfels *s)
{
	cells c = { s, 0 };
	double extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)s->maximum[k] - (double)s->minimum[k]);
	for (int level = LEVEL; level > 0 && extent > 0; level--) {
		size_t occupied = 0;
		c.per_metre = ldexp((double)((1 << 21) - 1) / extent, level - 21);
		for (size_t first = 0; first < s->count; first = end_of_cell(&c, first))
			occupied++;
		if ((double)s->count >= IN_A_CELL * (double)occupied)
			break;
	}
	return c;
}

/*
 * Fills area, radius and spacing roughly, from how many points share a coarse cell of space, and
 * minds no surface: for those who choose.
 */
static gw_status estimate_roughly(gw_surfels *s, gw_error *error)
{
	cells c = choose_cells(s);
	double width = c.per_metre > 0 ? 1 / c.per_metre : FLT_MIN;
	size_t n = s->count;
	s->area = gw_allocate_array(n, sizeof *s->area);
	s->radius = gw_allocate_array(n, sizeof *s->radius);
	if (!s->area || !s->radius)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the sizes of %zu points", n);
	for (size_t first = 0, last; first < n; first = last) {
		last = end_of_cell(&c, first);
		double area = fmax(width * width / (double)(last - first), (double)FLT_MIN);
		for (size_t i = first; i < last; i++) {
			s->area[i] = (float)area;
			s->radius[i] = (float)sqrt(DISC_POINTS * area / M_PI);
		}
	}
	s->spacing = sqrtf(gw_nth_element(s->area, n, n / 2));
	return GW_OK;
}

static void move_floats(float *array, size_t width, size_t to, size_t from)
{
	for (size_t k = 0; array && k < width; k++)
		array[width * to + k] = array[width * from + k];
}

/* `place` receives where each surfel goes; UINT32_MAX: nowhere. */
static void keep_chosen(gw_surfels *s, const uint8_t *chosen, uint32_t *place)
{
	size_t kept = 0;
	for (size_t i = 0; i < s->count; i++) {
		place[i] = chosen[i] ? (uint32_t)kept : UINT32_MAX;
		if (!chosen[i])
			continue;
		move_floats(s->position, 3, kept, i);
		move_floats(s->normal, 3, kept, i);
		move_floats(s->normal_length, 1, kept, i);
		move_floats(s->albedo, 3, kept, i);
		move_floats(s->emission, 3, kept, i);
		move_floats(s->transparency, 1, kept, i);
		s->two_sided[kept++] = s->two_sided[i];
	}
	s->count = kept;
	for (size_t i = 0; i < s->point_count; i++)
		if (s->surfel_of_point[i] != UINT32_MAX)
			s->surfel_of_point[i] = place[s->surfel_of_point[i]];
}

static gw_status choose(const gw_surfels_options *options, gw_surfels *s, uint8_t *chosen,
						gw_error *error)
{
	gw_status status = options->choose(options->chooser, s, chosen, error);
	uint32_t *place = gw_allocate_array(s->count, sizeof *place);
	if (status == GW_OK && !place)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu places", s->count);
	size_t kept = 0;
	for (size_t i = 0; i < s->count; i++)
		kept += chosen[i];
	for (size_t i = 0; i < s->count && kept <= GW_NEIGHBOURS; i++) {
		kept += !chosen[i];
		chosen[i] = 1;
	}
	if (status == GW_OK && kept < s->count)
		keep_chosen(s, chosen, place);
	free(place);
	return status;
}

gw_status gw_surfels_choose(const gw_surfels_options *options, gw_surfels *s, gw_error *error)
{
	uint8_t *chosen = gw_allocate_zeros(s->count, 1);
	bool complete = s->normals_given == s->count || !options->choose_by_place;
	gw_status status = estimate_roughly(s, error);
	if (status == GW_OK && !chosen)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to choose from %zu points", s->count);
	if (status == GW_OK)
		status = choose(options, s, chosen, error);
	free(chosen);
	free(s->area);
	free(s->radius);
	s->area = s->radius = NULL;
	s->normals_given = complete ? s->count : 0; /* 0: they are looked for again */
	return status;
}
