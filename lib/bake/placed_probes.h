/*
 * placed_probes.h - what is known of a scene's probes whatever light shines: where they are, and
 * what the rays of their maps met. A scene keeps it, so that other light takes no rays, and so does
 * a transport (transport.h).
 */
#ifndef PLACED_PROBES_H
#define PLACED_PROBES_H

#include "light/probe_trace.h"

/* The numbers of it, at fixed places and of fixed size; lengths are in the scene's units. */
typedef struct gw_probe_numbers {
	double seeable, seen; /* as of gw_probes, as are: */
	uint64_t candidates, first;
	uint64_t seed; /* of gw_probes_options, as are: */
	uint32_t size, most, moves, grid;
	float margin;
	float minimum[3], maximum[3]; /* where probes may stand, in the surfels' frame */
	uint32_t count;               /* of probes; 0: none were placed */
} gw_probe_numbers;

typedef struct gw_placed_probes {
	gw_probe_numbers numbers;
	float *radius; /* one a probe: to the nearest surfel */
	gw_probe_hits hits;
} gw_placed_probes;

/* What of the numbers follows from options; the rest is 0.
 *   exponent   lengths of the scene are metres times two to the power of this */
gw_probe_numbers gw_probe_numbers_of(const gw_probes_options *options, int exponent);

/* The first option in which numbers differ, with both values; NULL where all are the same. */
const char *gw_probe_numbers_differ(const gw_probe_numbers *numbers, const gw_probe_numbers *other,
									double value[2]);

/* Whether these numbers can be those of probes, or of none: no size overflows. */
bool gw_probe_numbers_fit(const gw_probe_numbers *numbers);

/* Whether places and distances are such that no look at the maps goes astray. */
bool gw_placed_probes_fit(const gw_placed_probes *placed);

/* Stores the numbers in probes without arrays. */
void gw_probe_numbers_restore(const gw_probe_numbers *numbers, gw_placed_probes *placed);

void gw_placed_probes_clear(gw_placed_probes *placed); /* empty ones are accepted */

#endif
