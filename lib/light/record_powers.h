/*
 * record_powers.h - how much light facets reflect of what records gather: a weighted sum over the
 * records, whose weights are found once.
 */
#ifndef RECORD_POWERS_H
#define RECORD_POWERS_H

#include "light/records.h"

typedef struct gw_record_powers {
	float *power; /* 3 a record: what its irradiance of 1 makes the facets reflect, as
					 luminance times area in leaf cells^2 */
} gw_record_powers;

/* Finds them, once facets have their records' weights. On success the caller clears *powers; on
 * failure it is empty. */
gw_status gw_record_powers_find(const gw_record_context *on, gw_record_powers *powers,
								gw_error *error);
void gw_record_powers_clear(gw_record_powers *powers); /* an empty one is accepted */

/* What records->gathered amounts to. Of what is below 0, its amount counts. */
typedef struct gw_gathered_light {
	double power;    /* luminance times area, leaf cells^2, that all facets reflect of it */
	double carriers; /* how many records it comes by: (sum of their parts)^2 / sum of squares */
	double largest;  /* irradiance of any record, in any channel */
} gw_gathered_light;

gw_status gw_record_powers_measure(const gw_record_context *on, const gw_record_powers *powers,
								   gw_gathered_light *light, gw_error *error);

#endif
