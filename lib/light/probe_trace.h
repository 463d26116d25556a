/*
 * probe_trace.h - what probes see: octahedral maps of radiance, normals and distances (Wang 2018,
 * section 4.3). What rays meet in the octree is traced once, and shown in any light.
 */
#ifndef PROBE_TRACE_H
#define PROBE_TRACE_H

#include "glowworm_probes.h"
#include "light/sky_map.h"
#include "octree/octree_bindings.h"

/* What the rays of probes met, whatever light shines there. */
typedef struct gw_probe_hits {
	size_t count;    /* of probes */
	uint32_t size;   /* texels a side of their maps */
	float *place;    /* 4 a probe: grid coordinates, and 0 */
	uint32_t *facet; /* a texel: GW_NONE where nothing is, and facet_count where rays slipped
						through rock and nobody knows what is there: it counts as dark and far */
	float *distance; /* a texel: leaf cells, where a facet is */
	float *behind;   /* a probe, or NULL; the caller's: of rays that pass or meet surface the share
						that passed its back before they met any */
} gw_probe_hits;

/* Of a scene, what is traced, and what is shown. */
typedef struct gw_probe_scene {
	gw_passes *passes;
	const gw_octree *octree;
	/* Texel buffer, vec4 a facet: what facets send out. NULL: maps of radiance stay dark. */
	const gw_buffer *facet_radiance;
	gw_sky_view sky; /* what comes from where nothing is */
	uint32_t seed, threads;
} gw_probe_scene;

/*
 * Traces the texels of probes. A ray that has slipped through rock, out of a compartment that is
 * closed or to surface in another one (compartments.h), takes what a texel beside it met; where all
 * rays of a probe have, it sees none.
 *   hits   count, size and places given; receives the rest, in part on failure
 */
gw_status gw_probe_hits_trace(const gw_probe_scene *scene, gw_probe_hits *hits, gw_error *error);
void gw_probe_hits_clear(gw_probe_hits *hits); /* empty ones are accepted */

/*
 * Makes the maps of probes of what their rays met, and harmonics, least and greatest distances.
 * Nothing is traced.
 *   probes   dark, with room for all maps; distances are in leaf cells times `metres`
 */
gw_status gw_probe_hits_show(const gw_probe_scene *scene, const gw_probe_hits *hits, double metres,
							 gw_probes *probes, gw_error *error);

#endif
