/* scanner_sight.c - see scanner_sight.h. */
#include "normals/scanner_sight.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Width of a cell in reaches of 16 neighbours: about twenty surfels on a plane through it. */
#define CELL_REACHES 2.0
/* Of surfels with a longer reach there are so few that holes in the grid do little harm. */
#define REACH_SHARE 0.8
#define REACH_SAMPLES 65536u

/* Surfels that make a cell a surface. */
#define CELL_LEAST 3u

/* A crossing that is so far from the surfel's own plane, in cells, is another surface. */
#define OTHER_SURFACE 0.5

/* Planes are taken to reach a little out of their cells, so that no way leads between two. */
#define CELL_MARGIN 0.1

/* Least cosine at which a scanner is clearly on one side of a plane. */
#define CLEAR_SIDE 0.05

/* Cells that a way is followed through. */
#define STEPS_MOST 4096

/* Surfels between two looks whether to stop. */
#define PART 65536u

/* Places and ways to each side of them that say how open a scene is. */
#define OPEN_PLACES 1500u
#define OPEN_WAYS 12

typedef struct cell {
	int32_t at[3];
	uint32_t count; /* 0: free */
	float normal[3];
	double middle[3]; /* a sum at first */
} cell;

typedef struct sight {
	const gw_surfels *surfels;
	const gw_scanner_places *places;
	uint64_t *seen_by;
	size_t first, every; /* surfels that are looked at: of the part, and one in so many */
	float *reach;        /* metres, of one surfel in `stride` */
	size_t stride;
	double width; /* of a cell, metres */
	cell *table;
	size_t size; /* a power of two */
} sight;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ------------------------------------------------------------------------------------ the grid */

static size_t place_of(const sight *w, const int32_t at[3])
{
	uint64_t key = (uint64_t)(uint32_t)at[0] * 0x9e3779b97f4a7c15u;
	key = (key ^ (uint64_t)(uint32_t)at[1]) * 0xc2b2ae3d27d4eb4fu;
	key = (key ^ (uint64_t)(uint32_t)at[2]) * 0x165667b19e3779f9u;
	return (size_t)(key >> 20) & (w->size - 1);
}

/* The cell with these coordinates, or the free one where it would be. */
static cell *find_cell(const sight *w, const int32_t at[3])
{
	size_t i = place_of(w, at);
	while (w->table[i].count && memcmp(w->table[i].at, at, sizeof w->table[i].at) != 0)
		i = (i + 1) & (w->size - 1);
	return &w->table[i];
}

static bool cell_at(const sight *w, const double p[3], int32_t at[3])
{
	for (int k = 0; k < 3; k++) {
		double c = floor(p[k] / w->width);
		if (!(fabs(c) < 0x1p30))
			return false;
		at[k] = (int32_t)c;
	}
	return true;
}

static void note_reach(void *user, size_t surfel, const gw_neighbour_list *list)
{
	sight *w = user;
	if (surfel % w->stride == 0)
		w->reach[surfel / w->stride] = list->count ? list->distance[list->count - 1] : 0.0f;
}

static gw_status measure(sight *w, gw_neighbours *search, gw_error *error)
{
	size_t count = w->surfels->count;
	w->stride = 1 + count / REACH_SAMPLES;
	size_t samples = (count + w->stride - 1) / w->stride;
	w->reach = gw_allocate_array(samples, sizeof *w->reach);
	if (!w->reach)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to see %zu points", count);
	gw_status status = gw_neighbours_visit_reach(search, note_reach, w, error);
	if (status == GW_OK)
		w->width = CELL_REACHES * (double)gw_nth_element(w->reach, samples,
														 (size_t)(REACH_SHARE * (double)samples));
	return status;
}

/* Normals of either sign are summed up along the cell's first one. */
static void add_surfel(const sight *w, size_t surfel)
{
	const float *n = w->places->plane + 4 * surfel, *q = w->surfels->position + 3 * surfel;
	const double p[3] = { (double)q[0], (double)q[1], (double)q[2] };
	int32_t at[3];
	if (!cell_at(w, p, at))
		return;
	cell *c = find_cell(w, at);
	memcpy(c->at, at, sizeof at);
	float along = c->normal[0] * n[0] + c->normal[1] * n[1] + c->normal[2] * n[2];
	for (int k = 0; k < 3; k++) {
		c->normal[k] += along < 0 ? -n[k] : n[k];
		c->middle[k] += p[k];
	}
	c->count++;
}

static gw_status fill_grid(sight *w, gw_error *error)
{
	w->size = 64;
	while (w->size < 2 * w->surfels->count)
		w->size *= 2;
	w->table = gw_allocate_zeros(w->size, sizeof *w->table);
	if (!w->table)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to see %zu points", w->surfels->count);
	for (size_t i = 0; i < w->surfels->count; i++)
		add_surfel(w, i);
	for (size_t i = 0; i < w->size; i++)
		for (int k = 0; k < 3 && w->table[i].count; k++)
			w->table[i].middle[k] /= (double)w->table[i].count;
	return GW_OK;
}

/* ---------------------------------------------------------------------------------------- rays */

/* A surfel and the straight way from it. */
typedef struct way {
	double from[3], normal[3], direction[3], length;
} way;

/* Does the way cross a cell's plane within the cell, off the surfel's own plane? */
static bool is_crossed(const sight *w, const cell *c, const way *y)
{
	if (c->count < CELL_LEAST)
		return false;
	double n[3], to[3], height = 0;
	for (int k = 0; k < 3; k++) {
		n[k] = (double)c->normal[k];
		to[k] = c->middle[k] - y->from[k];
	}
	double rate = dot(n, y->direction), t = dot(n, to) / rate;
	if (!(t > 0 && t < y->length - w->width) || rate == 0)
		return false;
	for (int k = 0; k < 3; k++) {
		double x = y->from[k] + t * y->direction[k], low = c->at[k] * w->width;
		double margin = CELL_MARGIN * w->width;
		if (x < low - margin || x > low + w->width + margin)
			return false;
		height += y->normal[k] * (x - y->from[k]);
	}
	return fabs(height) > OTHER_SURFACE * w->width;
}

/* Goes from cell to cell (Amanatides and Woo, A Fast Voxel Traversal Algorithm, 1987). */
static bool is_blocked(const sight *w, const way *y)
{
	int32_t at[3];
	double next[3];
	if (!cell_at(w, y->from, at))
		return false;
	for (int k = 0; k < 3; k++) {
		double edge = (at[k] + (y->direction[k] > 0 ? 1 : 0)) * w->width;
		next[k] = y->direction[k] != 0 ? (edge - y->from[k]) / y->direction[k] : INFINITY;
	}
	for (int step = 0; step < STEPS_MOST; step++) {
		if (is_crossed(w, find_cell(w, at), y))
			return true;
		int k = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
		if (!(next[k] < y->length))
			return false;
		at[k] += y->direction[k] > 0 ? 1 : -1;
		next[k] += w->width / fabs(y->direction[k]);
	}
	return false;
}

/* The way to a scanner; false where there is none. */
static bool find_way(const sight *w, size_t scanner, way *y)
{
	double squared = 0;
	for (size_t k = 0; k < 3; k++) {
		y->direction[k] = w->places->position[3 * scanner + k] - y->from[k];
		squared += y->direction[k] * y->direction[k];
	}
	y->length = sqrt(squared);
	for (int k = 0; k < 3; k++)
		y->direction[k] /= y->length;
	return y->length > 0 && isfinite(y->length);
}

/* Does a scanner see a surfel's front, or either side where both are lit? */
static bool sees(const sight *w, size_t scanner, size_t surfel, way *y)
{
	if (!find_way(w, scanner, y))
		return false;
	double cosine = dot(y->direction, y->normal);
	if (w->surfels->two_sided[surfel])
		cosine = fabs(cosine);
	return cosine > CLEAR_SIDE && !is_blocked(w, y);
}

static void look_for_scanners(void *user, size_t first, size_t last, uint32_t worker)
{
	const sight *w = user;
	size_t step = gw_sight_step(w->places->count);
	(void)worker;
	for (size_t at = first; at < last; at++) {
		size_t surfel = (w->first + at) * w->every;
		way y;
		for (size_t k = 0; k < 3; k++) {
			y.from[k] = (double)w->surfels->position[3 * surfel + k];
			y.normal[k] = (double)w->places->plane[4 * surfel + k];
		}
		for (size_t i = 0; i * step < w->places->count; i++)
			if (sees(w, i * step, surfel, &y))
				w->seen_by[surfel] |= (uint64_t)1 << i;
	}
}

/* In parts, between which somebody may stop it. */
static gw_status look_for_all(sight *w, const gw_surfels_options *o, gw_error *error)
{
	size_t asked = w->places->count / gw_sight_step(w->places->count);
	w->every = 1 + w->surfels->count * asked / GW_SIGHTS;
	size_t count = (w->surfels->count + w->every - 1) / w->every;
	for (w->first = 0; w->first < count; w->first += PART) {
		if (o->cancelled && o->cancelled(o->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while looking who saw what");
		size_t left = count - w->first;
		gw_parallel_for(o->threads, left < PART ? left : PART, 256, look_for_scanners, w);
	}
	return GW_OK;
}

gw_status gw_scanners_see(gw_neighbours *search, const gw_surfels *surfels,
						  const gw_scanner_places *places, const gw_surfels_options *options,
						  uint64_t *seen_by, gw_error *error)
{
	sight w = { .surfels = surfels, .places = places, .seen_by = seen_by };
	gw_status status = measure(&w, search, error);
	if (status == GW_OK && w.width > 0 && isfinite(w.width))
		status = fill_grid(&w, error);
	if (status == GW_OK && w.table)
		status = look_for_all(&w, options, error);
	free(w.reach);
	free(w.table);
	return status;
}

/* ------------------------------------------------------------------------------ how open it is */

/* The way with a number, evenly over a cap (a spherical Fibonacci set): what grazes the surface
 * would leave it unseen where that is bent. */
static void number_way(int i, const double normal[3], way *y)
{
	double z = 1 - 0.65 * (2 * i + 1) / (2.0 * OPEN_WAYS), angle = 2.399963229728653 * i;
	double r = sqrt(1 - z * z);
	float axis[3], tangent[3], bitangent[3];
	for (int k = 0; k < 3; k++)
		axis[k] = (float)normal[k];
	gw_tangent_frame(axis, tangent, bitangent);
	for (int k = 0; k < 3; k++)
		y->direction[k] = z * normal[k] + r * cos(angle) * (double)tangent[k] +
						  r * sin(angle) * (double)bitangent[k];
}

/* From some of the surfels, to the front and to the back. */
static void count_open(const sight *w, double share[2])
{
	const gw_surfels *s = w->surfels;
	size_t stride = 1 + s->count / OPEN_PLACES, ways = 0, open[2] = { 0 };
	double diagonal = 0;
	for (int k = 0; k < 3; k++)
		diagonal += pow((double)s->maximum[k] - (double)s->minimum[k], 2);
	for (size_t i = 0; i < s->count; i += stride, ways += OPEN_WAYS)
		for (int side = 0; side < 2; side++) {
			way y = { .length = sqrt(diagonal) + w->width };
			for (size_t k = 0; k < 3; k++) {
				y.from[k] = (double)s->position[3 * i + k];
				y.normal[k] = (side ? -1 : 1) * (double)w->places->plane[4 * i + k];
			}
			for (int j = 0; j < OPEN_WAYS; j++) {
				number_way(j, y.normal, &y);
				open[side] += !is_blocked(w, &y);
			}
		}
	for (int side = 0; side < 2; side++)
		share[side] = (double)open[side] / (double)ways;
}

gw_status gw_sight_open_share(gw_neighbours *search, const gw_surfels *surfels,
							  const gw_scanner_places *places, double share[2], gw_error *error)
{
	sight w = { .surfels = surfels, .places = places };
	share[0] = share[1] = 1;
	gw_status status = measure(&w, search, error);
	if (status == GW_OK && w.width > 0 && isfinite(w.width))
		status = fill_grid(&w, error);
	if (status == GW_OK && w.table)
		count_open(&w, share);
	free(w.reach);
	free(w.table);
	return status;
}
