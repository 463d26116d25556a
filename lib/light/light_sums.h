/*
 * light_sums.h - light of all facets and all records, added up on the device. Sums are put off as
 * passes are, and brought down together, so that a bounce need not wait for each.
 *
 * The order of adding depends on nothing but the number of elements: same light, same bytes. What
 * is added is rounded as floats are, the sums hardly: they keep what they round off
 * (light_sum.comp).
 */
#ifndef LIGHT_SUMS_H
#define LIGHT_SUMS_H

#include "light/records.h"

typedef struct gw_light_sum {
	double power; /* sum of the amounts of light, luminance times area in leaf cells^2 */
	double squares;
	float largest; /* component of the light, and at least 0 */
} gw_light_sum;

/* All zero are none. */
typedef struct gw_light_sums {
	gw_buffer part; /* both sums, and parts of them */
} gw_light_sums;

/* Makes room for the sums over an octree's facets and so many records. */
gw_status gw_light_sums_create(const gw_record_context *on, gw_light_sums *sums, gw_error *error);
void gw_light_sums_destroy(gw_gpu *gpu, gw_light_sums *sums); /* none are accepted */

/* Adds up what all facets send out: texels R32G32B32A32_SFLOAT, facet_count. Its amounts are
 * those of the luminance, its largest component not. */
gw_status gw_light_sums_facets(const gw_record_context *on, gw_light_sums *sums,
							   const gw_buffer *facet_radiance, gw_error *error);

/*
 * Adds up records->gathered, of which amounts count.
 *   power   R32G32B32A32_SFLOAT, one a record: what an irradiance of 1 amounts to
 */
gw_status gw_light_sums_records(const gw_record_context *on, gw_light_sums *sums,
								const gw_buffer *power, gw_error *error);

/* Brings down the latest sums; of one that was not made yet, zeros. */
gw_status gw_light_sums_read(gw_gpu *gpu, const gw_light_sums *sums, gw_light_sum *facets,
							 gw_light_sum *records, gw_error *error);

#endif
