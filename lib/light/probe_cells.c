/*
 * probe_cells.c - see probe_cells.h.
 */
#include "light/probe_cells.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "light/octahedral.h"

#include <stdlib.h>

/* Cells along the longest side of the bounds. */
#define CELLS 64

/* From the middle of a cell to its corner, in its sides. */
#define HALF_DIAGONAL 0.8660254

typedef struct search {
	const gw_probes *probes;
	double size;
	int32_t side[3]; /* cells */
	int32_t *best;   /* GW_PROBES_OF_CELL a cell of all */
} search;

/* The distance to the middle of a cell, or a negative number where the probe does not see it. */
static double distance_seen(const search *s, size_t probe, const double middle[3])
{
	const gw_probes *p = s->probes;
	const double *at = p->probe[probe].position;
	const gw_vec3 way = { (float)(middle[0] - at[0]), (float)(middle[1] - at[1]),
						  (float)(middle[2] - at[2]) };
	const double distance = sqrt((double)gw_dot(way, way));
	float u, v;
	if (!(distance > 0.0))
		return 0.0;
	gw_octahedral_place(way, &u, &v);
	const float half = 0.5f * (float)p->size, last = (float)(p->size - 1);
	const size_t column = (size_t)gw_smaller(gw_larger((u + 1.0f) * half, 0.0f), last);
	const size_t row = (size_t)gw_smaller(gw_larger((v + 1.0f) * half, 0.0f), last);
	const size_t texel = (probe * p->size + row) * p->size + column;
	return distance <= (double)p->distance[texel] + HALF_DIAGONAL * s->size ? distance : -1.0;
}

/* The nearest of the probes that see a cell, by insertion; of equal ones the first. */
static void choose(const search *s, const double middle[3], int32_t best[GW_PROBES_OF_CELL])
{
	double near[GW_PROBES_OF_CELL];
	int count = 0;
	for (int i = 0; i < GW_PROBES_OF_CELL; i++)
		best[i] = -1;
	for (size_t k = 0; k < s->probes->count; k++) {
		double distance = distance_seen(s, k, middle);
		if (distance < 0.0 || (count == GW_PROBES_OF_CELL && distance >= near[count - 1]))
			continue;
		int at = count < GW_PROBES_OF_CELL ? count++ : count - 1;
		for (; at > 0 && near[at - 1] > distance; at--) {
			near[at] = near[at - 1];
			best[at] = best[at - 1];
		}
		near[at] = distance;
		best[at] = (int32_t)k;
	}
}

static void coordinates_of(const search *s, size_t i, int32_t cell[3])
{
	cell[0] = (int32_t)(i % (size_t)s->side[0]);
	cell[1] = (int32_t)(i / (size_t)s->side[0] % (size_t)s->side[1]);
	cell[2] = (int32_t)(i / (size_t)s->side[0] / (size_t)s->side[1]);
}

static void choose_all(void *user, size_t first, size_t last, uint32_t worker)
{
	const search *s = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		int32_t cell[3];
		double middle[3];
		coordinates_of(s, i, cell);
		for (int k = 0; k < 3; k++)
			middle[k] = s->probes->minimum[k] + (cell[k] + 0.5) * s->size;
		choose(s, middle, s->best + GW_PROBES_OF_CELL * i);
	}
}

/* Keeps those that any probe sees. */
static gw_status keep(const search *s, size_t all, gw_probe_cells *cells, gw_error *error)
{
	for (size_t i = 0; i < all; i++)
		cells->count += s->best[GW_PROBES_OF_CELL * i] >= 0;
	cells->cell = gw_allocate_array(cells->count, 3 * sizeof *cells->cell);
	cells->probe = gw_allocate_array(cells->count, GW_PROBES_OF_CELL * sizeof *cells->probe);
	if (!cells->cell || !cells->probe)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu cells", cells->count);
	for (size_t i = 0, n = 0; i < all; i++) {
		const int32_t *best = s->best + GW_PROBES_OF_CELL * i;
		if (best[0] < 0)
			continue;
		coordinates_of(s, i, cells->cell + 3 * n);
		memcpy(cells->probe + GW_PROBES_OF_CELL * n++, best, GW_PROBES_OF_CELL * sizeof *best);
	}
	return GW_OK;
}

gw_status gw_probe_cells_find(gw_probes *probes, uint32_t threads, gw_error *error)
{
	search s = { .probes = probes };
	size_t all = 1;
	for (int k = 0; k < 3; k++)
		s.size = fmax(s.size, (probes->maximum[k] - probes->minimum[k]) / CELLS);
	for (int k = 0; k < 3; k++) {
		double cells = ceil((probes->maximum[k] - probes->minimum[k]) / s.size);
		s.side[k] = cells > 1.0 ? (int32_t)fmin(cells, CELLS) : 1;
		all *= (size_t)s.side[k];
	}
	memcpy(probes->cells.origin, probes->minimum, sizeof probes->cells.origin);
	probes->cells.size = s.size;
	s.best = gw_allocate_array(all, GW_PROBES_OF_CELL * sizeof *s.best);
	if (!s.best)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the probes of %zu cells", all);
	gw_parallel_for(threads, all, CELLS, choose_all, &s);
	gw_status status = keep(&s, all, &probes->cells, error);
	free(s.best);
	return status;
}

void gw_probe_cells_clear(gw_probe_cells *cells)
{
	free(cells->cell);
	free(cells->probe);
	*cells = (gw_probe_cells){ .count = 0 };
}
