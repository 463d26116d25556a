/*
 * side_components.c - see side_components.h.
 */
#include "estimate/side_components.h"

#include "base/memory.h"
#include "cloud/neighbours.h"

#include <math.h>
#include <stdlib.h>

/* Neighbours that lie higher than this share of their distance are not on the same surface. */
#define HEIGHT_MOST 0.35f

typedef struct components {
	const gw_surfels *surfels;
	uint32_t *near; /* GW_NEIGHBOURS a surfel; the surfel itself where there is none */
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

static void list_neighbours(void *user, size_t surfel, const gw_neighbour_list *list)
{
	components *p = user;
	for (uint32_t k = 0; k < GW_NEIGHBOURS; k++) {
		bool same = k < list->count && adjoin(p->surfels, surfel, list->index[k]);
		p->near[GW_NEIGHBOURS * surfel + k] = same ? list->index[k] : (uint32_t)surfel;
	}
}

static uint32_t find_root(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i) {
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

static void join_all(const components *p, uint32_t *parent)
{
	uint32_t count = (uint32_t)p->surfels->count;
	for (uint32_t i = 0; i < count; i++)
		parent[i] = i;
	for (uint32_t i = 0; i < count; i++)
		for (size_t k = 0; k < GW_NEIGHBOURS; k++) {
			uint32_t a = find_root(parent, i);
			uint32_t b = find_root(parent, p->near[GW_NEIGHBOURS * (size_t)i + k]);
			parent[a > b ? a : b] = a < b ? a : b;
		}
	for (uint32_t i = 0; i < count; i++)
		parent[i] = find_root(parent, i);
}

gw_status gw_side_components_find(const gw_surfels *surfels, uint32_t threads, uint32_t *component,
								  gw_error *error)
{
	const gw_surfels_options options = { .threads = threads };
	gw_neighbours *search = NULL;
	components p = { .surfels = surfels };
	p.near = gw_allocate_array(surfels->count, GW_NEIGHBOURS * sizeof *p.near);
	gw_status status = p.near ? gw_neighbours_open(surfels, &options, &search, error)
							  : gw_fail(error, GW_ERROR_MEMORY,
										"no memory for neighbours of %zu points", surfels->count);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, list_neighbours, &p, error);
	if (status == GW_OK)
		join_all(&p, component);
	gw_neighbours_close(search);
	free(p.near);
	return status;
}
