/*
 * host_products.h - the sparse products of bounces as loops of the host.
 *
 * Each does what the pass of a shader does, on the same buffers, but for roundings. They are for
 * devices that are the host's own processor (see passes.h): there the passes fetch lane by lane
 * and these loops take a fifth of their time, with as many processors. Work is cut into pieces that
 * do not depend on the number of threads, so neither do the results. Time is booked as that of the
 * pass.
 */
#ifndef HOST_PRODUCTS_H
#define HOST_PRODUCTS_H

#include "light/gather_rays.h"

/* lobe_shade.comp: lobe_radiance, of the lobes' interpolated irradiance and direct_share times
 * lobe_direct. */
void gw_host_shade(gw_passes *passes, const gw_octree *octree, const gw_records *records,
				   const gw_buffer *records_irradiance, const gw_buffer *lobe_direct,
				   float direct_share, gw_buffer *lobe_radiance);

/*
 * Bounces from records to records. Only lobes that rays hit matter to them, a third or a half of
 * all; and the energy that lobes reflect is a weighted sum over the records.
 */
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

/* As gw_host_shade with no direct light, for these lobes alone; others keep what they have. */
void gw_host_shade_hits(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_hit_lobes *hits, gw_buffer *lobe_radiance);

/* Luminance times area, leaf cells^2, that all lobes reflect of records->gathered; of what is below
 * 0, its amount. */
double gw_host_power(const gw_records *records, const gw_hit_lobes *hits);

/* record_gather.comp: records->gathered, of what the rays hit. */
void gw_host_gather(gw_passes *passes, const gw_ray_gather *gather, const gw_buffer *lobe_radiance,
					gw_records *records);

/* lobe_direct.comp: lobes, the mean over the surfels that lie in each lobe.
 *   surfels   vec4 a surfel
 *   lobes     receives vec4 a lobe slot */
void gw_host_average(gw_passes *passes, const gw_octree *octree, const gw_buffer *surfels,
					 gw_buffer *lobes);

/* record_add.comp: adds `count` vec4 of one buffer to those of another. */
void gw_host_add(gw_passes *passes, const gw_buffer *from, gw_buffer *to, uint64_t count);

#endif
