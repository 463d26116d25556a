/*
 * side_components.c - see side_components.h.
 */
#include "estimate/side_components.h"

#include "base/memory.h"
#include "cloud/neighbours.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Neighbours that lie higher than this share of their distance are not on the same surface. */
#define HEIGHT_MOST 0.35f

typedef struct components {
	const gw_surfels *surfels;
	_Atomic uint32_t *parent; /* one a surfel: of its component, itself or one before it */
} components;

/* Of one smooth surface: alike, and beside each other rather than above. */
static bool adjoin(const gw_surfels *s, size_t i, size_t j)
{
	const float *p = s->position + 3 * i, *q = s->position + 3 * j, *n = s->normal + 3 * i;
	float length = 0.0f, height = 0.0f;
	for (int k = 0; k < 3; k++) {
		length += (q[k] - p[k]) * (q[k] - p[k]);
		height += (q[k] - p[k]) * n[k];
	}
	return gw_surfels_alike(s, i, j) && fabsf(height) < HEIGHT_MOST * sqrtf(length);
}

/* The first surfel of a component, as far as it is known; shortens the way there. What others join
 * meanwhile lies beyond that one. */
static uint32_t find_first(_Atomic uint32_t *parent, uint32_t i)
{
	uint32_t next;
	while ((next = atomic_load_explicit(&parent[i], memory_order_relaxed)) != i) {
		uint32_t beyond = atomic_load_explicit(&parent[next], memory_order_relaxed);
		atomic_store_explicit(&parent[i], beyond, memory_order_relaxed);
		i = beyond;
	}
	return i;
}

/* Whichever threads join which surfels, of all that are joined the first one is found in the end.
 */
static void join(_Atomic uint32_t *parent, uint32_t a, uint32_t b)
{
	while ((a = find_first(parent, a)) != (b = find_first(parent, b))) {
		uint32_t later = a > b ? a : b, expected = later;
		if (atomic_compare_exchange_strong_explicit(&parent[later], &expected, a < b ? a : b,
													memory_order_relaxed, memory_order_relaxed))
			return;
	}
}

static void join_neighbours(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const components *c = user;
	for (uint32_t k = 0; k < list->count; k++)
		if (adjoin(c->surfels, surfel, list->index[k]))
			join(c->parent, (uint32_t)surfel, list->index[k]);
}

gw_status gw_side_components_find(const gw_surfels *surfels, uint32_t threads, uint32_t *component,
								  gw_error *error)
{
	/* One visit, without lists that stay. */
	const gw_surfels_options options = { .threads = threads,
										 .memory =
											 surfels->count * (uint64_t)GW_NEIGHBOURS_TREE_BYTES };
	gw_neighbours *search = NULL;
	components c = { surfels, gw_allocate_array(surfels->count, sizeof *c.parent) };
	gw_status status = c.parent ? gw_neighbours_open(surfels, &options, &search, error)
								: gw_fail(error, GW_ERROR_MEMORY,
										  "no memory for components of %zu points", surfels->count);
	for (uint32_t i = 0; i < surfels->count && status == GW_OK; i++)
		atomic_init(&c.parent[i], i);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, join_neighbours, &c, error);
	for (uint32_t i = 0; i < surfels->count && status == GW_OK; i++)
		component[i] = find_first(c.parent, i);
	gw_neighbours_close(search);
	free(c.parent);
	return status;
}
