/*
 * hit_lobes.h - bounces from records to records on the processor, where lobes can be left out.
 *
 * Only lobes that rays hit matter to such a bounce, a third or a half of all; and the energy that
 * lobes reflect is a weighted sum over the records. Work is cut into pieces that do not depend on
 * the number of threads, so neither do the results.
 */
#ifndef HIT_LOBES_H
#define HIT_LOBES_H

#include "light/gather_rays.h"

typedef struct gw_hit_lobes {
	uint32_t *slot; /* count, ascending: slots that rays hit */
	size_t count;
	float *power; /* 3 a record: what its irradiance of 1 makes the lobes reflect, as
					 luminance times area in leaf cells^2 */
} gw_hit_lobes;

/* Lists them. On success the caller clears *hits; on failure it is empty. */
gw_status gw_hit_lobes_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							const gw_ray_gather *gather, gw_hit_lobes *hits, gw_error *error);
void gw_hit_lobes_clear(gw_hit_lobes *hits); /* an empty one is accepted */

/* Shades these lobes alone with no direct light, as lobe_shade.comp does; others keep what they
 * have. */
void gw_hit_lobes_shade(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_hit_lobes *hits, gw_buffer *lobe_radiance);

/* Luminance times area, leaf cells^2, that all lobes reflect of records->gathered; of what is below
 * 0, its amount. */
double gw_hit_lobes_power(const gw_records *records, const gw_hit_lobes *hits);

#endif
