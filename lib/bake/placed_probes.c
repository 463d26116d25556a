/*
 * placed_probes.c - see placed_probes.h.
 */
#include "bake/placed_probes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(gw_probe_numbers) == 88, "there are no gaps between the numbers");

gw_probe_numbers gw_probe_numbers_of(const gw_probes_options *o, int exponent)
{
	return (gw_probe_numbers){ .seed = o->seed,
							   .size = o->size,
							   .most = o->count,
							   .moves = o->moves,
							   .grid = o->grid,
							   .margin = ldexpf(o->margin, exponent) };
}

const char *gw_probe_numbers_differ(const gw_probe_numbers *n, const gw_probe_numbers *other,
									double value[2])
{
	const struct {
		const char *name;
		double own, other;
	} rows[] = {
		{ "size of maps", n->size, other->size },
		{ "number of probes at most", n->most, other->most },
		{ "number of moves", n->moves, other->moves },
		{ "regular grid", n->grid, other->grid },
		{ "margin", (double)n->margin, (double)other->margin },
		{ "seed of probes", (double)n->seed, (double)other->seed },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		value[0] = rows[i].own;
		value[1] = rows[i].other;
		if (value[0] != value[1])
			return rows[i].name;
	}
	return NULL;
}

static bool are_bounds(const float minimum[3], const float maximum[3])
{
	for (int k = 0; k < 3; k++)
		if (!isfinite(minimum[k]) || !isfinite(maximum[k]) || !(minimum[k] <= maximum[k]))
			return false;
	return true;
}

bool gw_probe_numbers_fit(const gw_probe_numbers *n)
{
	static const gw_probe_numbers none = { .count = 0 };
	if (n->count == 0)
		return memcmp(n, &none, sizeof none) == 0;
	return n->size >= GW_PROBE_SIZE_LEAST && n->size <= GW_PROBE_SIZE_MOST &&
		   (n->size & (n->size - 1)) == 0 && n->grid <= GW_PROBE_GRID_MOST && isfinite(n->margin) &&
		   isfinite(n->seeable) && isfinite(n->seen) && are_bounds(n->minimum, n->maximum);
}

bool gw_placed_probes_fit(const gw_placed_probes *placed)
{
	const gw_probe_hits *h = &placed->hits;
	const size_t texels = h->count * h->size * h->size;
	for (size_t i = 0; i < h->count; i++) {
		const float *at = h->place + 4 * i;
		if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]) ||
			!isfinite(placed->radius[i]))
			return false;
	}
	for (size_t i = 0; i < texels; i++)
		if (!isfinite(h->distance[i]) || h->distance[i] < 0.0f)
			return false;
	return true;
}

void gw_probe_numbers_restore(const gw_probe_numbers *numbers, gw_placed_probes *placed)
{
	*placed = (gw_placed_probes){ .numbers = *numbers };
	placed->hits.count = numbers->count;
	placed->hits.size = numbers->size;
}

void gw_placed_probes_clear(gw_placed_probes *placed)
{
	free(placed->radius);
	gw_probe_hits_clear(&placed->hits);
	*placed = (gw_placed_probes){ .radius = NULL };
}
