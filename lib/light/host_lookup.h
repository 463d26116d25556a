/*
 * host_lookup.h - the passes that look for the records near a point, as loops of the host.
 *
 * As host_rays.h: each does what the pass of a shader does, but for roundings, on devices that are
 * the host's own processor.
 */
#ifndef HOST_LOOKUP_H
#define HOST_LOOKUP_H

#include "light/records.h"
#include "light/transport_layout.h"

/* lobe_weights.comp: records->lobe_record and lobe_weight. `reach` is as of
 * gw_records_weigh_lobes. */
void gw_host_weigh_lobes(gw_passes *passes, const gw_octree *octree, gw_records *records,
						 const gw_buffer *reach, const gw_lookup_push *push);

/* read_back.comp, for `count` surfels from push->surfel_first on. `reach`, `record` and `weight`
 * are as of gw_records_weigh_surfels. */
void gw_host_weigh_surfels(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						   const gw_buffer *reach, const gw_lookup_push *push, size_t count,
						   gw_buffer *record, gw_buffer *weight);

#endif
