/*
 * probe_trace.h - what probes see: octahedral maps of radiance, normals and distances (Wang 2018,
 * section 4.3), traced through the octree.
 */
#ifndef PROBE_TRACE_H
#define PROBE_TRACE_H

#include "glowworm_probes.h"
#include "light/sky_map.h"
#include "octree/octree_bindings.h"

typedef struct gw_probe_scene {
	gw_passes *passes;
	const gw_octree *octree;
	/* Texel buffer, vec4 a facet: what facets send out. NULL: maps of radiance stay dark. */
	const gw_buffer *facet_radiance;
	uint32_t *facet; /* NULL, or receives the facet of each texel of all maps, GW_NONE for none */
	gw_sky_view sky; /* what comes from where nothing is */
	uint32_t seed, threads;
} gw_probe_scene;

/*
 * Traces the maps of probes, and makes harmonics, least and greatest distances of them. A ray
 * that has slipped through rock, out of a compartment that is closed or to surface in another one
 * (compartments.h), takes what a texel beside it met; where all rays of a probe have, it sees none.
 *   place    4 * probes->count: grid coordinates, and 0
 *   probes   with room for all maps; distances are in leaf cells times `metres`
 */
gw_status gw_probes_trace(const gw_probe_scene *scene, const float *place, double metres,
						  gw_probes *probes, gw_error *error);

#endif
