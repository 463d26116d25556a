/*
 * surface_owners.c - see surface_owners.h.
 */
#include "bake/surface_owners.h"

#include "base/memory.h"
#include "cloud/neighbour_index.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Points of the surface among which one is looked for that faces the same way. */
#define AROUND 8u

#define QUERIES 256u /* points that are looked up at once */
#define CHUNK 8192u
#define FACING 0.5f /* least cosine between normals of one surface */

/* Of differences, metres: their squares are no more than single precision holds. */
#define FARTHEST 1e15

typedef struct search {
	const gw_points *points;
	const gw_point_subset *surface;
	double middle[3];
	float *place;  /* 3 a row, from the middle */
	uint32_t *row; /* of the surface */
	size_t rows;
	gw_neighbour_index *index;
	uint32_t *owner;
	atomic_bool failed;
} search;

bool gw_owners_may_have(const gw_points *p, size_t i)
{
	const double *at = p->position + 3 * i;
	bool stray = p->stray && p->stray[i] && !p->keep_strays;
	return isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]) && !stray &&
		   !(p->opacity && !(p->opacity[i] > 0.0f));
}

/* From the middle; false where that is too far. */
static bool place_of(const search *s, const double *position, float place[3])
{
	bool near = true;
	for (size_t c = 0; c < 3; c++) {
		double away = position[c] - s->middle[c];
		near = near && fabs(away) < FARTHEST;
		place[c] = (float)away;
	}
	return near;
}

static bool build(search *s, uint32_t threads)
{
	const gw_points *p = &s->surface->points;
	s->place = gw_allocate_array(p->count, 3 * sizeof *s->place);
	s->row = gw_allocate_array(p->count, sizeof *s->row);
	if (!s->place || !s->row)
		return false;
	for (size_t k = 0; k < p->count; k++) {
		if (!gw_owners_may_have(p, k))
			continue;
		for (size_t c = 0; c < 3 && s->rows == 0; c++)
			s->middle[c] = p->position[3 * k + c];
		if (!place_of(s, p->position + 3 * k, s->place + 3 * s->rows))
			continue;
		s->row[s->rows++] = (uint32_t)k;
	}
	s->index = s->rows > 0 ? gw_neighbour_index_build(s->place, s->rows, threads) : NULL;
	return s->index || s->rows == 0;
}

/* Whether the normals of both say that they are of two surfaces. */
static bool face_apart(const float *a, const float *b)
{
	float lengths =
		(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
	float cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
	return lengths > 0.0f && isfinite(lengths) && cosine < FACING * sqrtf(lengths);
}

/* Of those found, nearest first. */
static uint32_t choose(const search *s, size_t point, const int *found, size_t count)
{
	const float *normal = s->points->normal, *of_surface = s->surface->normal;
	for (size_t k = 0; k < count && normal && of_surface; k++) {
		uint32_t row = s->row[found[k]];
		if (!face_apart(normal + 3 * point, of_surface + 3 * (size_t)row))
			return row;
	}
	return s->row[found[0]];
}

static bool look_up(const search *s, const size_t *point, const float *query, size_t count)
{
	size_t most = s->points->normal ? AROUND : 1, around = s->rows < most ? s->rows : most;
	int found[AROUND * QUERIES];
	float squared[AROUND * QUERIES];
	if (count > 0 && !gw_neighbour_index_search(s->index, query, count, around, found, squared))
		return false;
	for (size_t i = 0; i < count; i++)
		s->owner[point[i]] = choose(s, point[i], found + around * i, around);
	return true;
}

static void find_some(void *user, size_t first, size_t last, uint32_t worker)
{
	search *s = user;
	size_t point[QUERIES], count = 0;
	float query[3 * QUERIES];
	bool good = true;
	(void)worker;
	for (size_t i = first; i < last && good; i++) {
		s->owner[i] = GW_OWNER_NONE;
		if (!s->index || !gw_owners_may_have(s->points, i) ||
			!place_of(s, s->points->position + 3 * i, query + 3 * count))
			continue;
		point[count++] = i;
		if (count == QUERIES) {
			good = look_up(s, point, query, count);
			count = 0;
		}
	}
	if (!good || !look_up(s, point, query, count))
		atomic_store_explicit(&s->failed, true, memory_order_relaxed);
}

gw_status gw_owners_find(const gw_points *points, const gw_point_subset *surface, uint32_t threads,
						 uint32_t *owner, gw_error *error)
{
	search s = { .points = points, .surface = surface, .owner = owner };
	bool good = build(&s, threads);
	if (good)
		gw_parallel_for(threads, points->count, CHUNK, find_some, &s);
	good = good && !atomic_load_explicit(&s.failed, memory_order_relaxed);
	gw_neighbour_index_free(s.index);
	free(s.place);
	free(s.row);
	return good ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY, "no memory to thin %zu points", points->count);
}
