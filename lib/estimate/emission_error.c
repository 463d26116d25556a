/*
 * emission_error.c - see emission_error.h.
 */
#include "estimate/emission_error.h"

#include "base/luminance.h"

#include <math.h>
#include <string.h>

#define DISC_RANK 8 /* of the neighbour to which a disc reaches */

static bool differ(const gw_surfels *s, size_t i, size_t j)
{
	return memcmp(s->emission + 3 * i, s->emission + 3 * j, 3 * sizeof *s->emission) != 0;
}

/* Mean over the neighbours of the squared difference of what is emitted. */
static double difference_at(const gw_surfels *s, size_t i)
{
	size_t last = i + GW_ADJOIN_REACH < s->count ? i + GW_ADJOIN_REACH : s->count - 1, j = i + 1;
	double own = gw_luminance(s->emission + 3 * i), sum = 0.0;
	uint32_t neighbours = 0;
	while (j <= last && !differ(s, i, j))
		j++;
	if (j > last)
		return 0.0;
	for (j = i + 1; j <= last; j++) {
		if (!gw_surfels_adjoin(s, i, j))
			continue;
		double off = gw_luminance(s->emission + 3 * j) - own;
		sum += off * off;
		neighbours++;
	}
	return neighbours ? sum / neighbours : 0.0;
}

double gw_emission_error(const gw_surfels *surfels)
{
	double power = 0.0, variance = 0.0;
	for (size_t i = 0; surfels->emission && i < surfels->count; i++) {
		double area = (double)surfels->area[i], radius = (double)surfels->radius[i];
		double length = area / (radius * 4 / (3 * M_PI)), spacing = radius * sqrt(M_PI / DISC_RANK);
		power += area * gw_luminance(surfels->emission + 3 * i);
		variance +=
			GW_CELL_VARIANCE * length * spacing * spacing * spacing * difference_at(surfels, i);
	}
	return power > 0.0 ? sqrt(variance) / power : 0.0;
}
