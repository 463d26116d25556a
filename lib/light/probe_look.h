/*
 * probe_look.h - what places see by the maps of probes (Wang 2018, section 4.3): which texel of
 * which map shows it.
 */
#ifndef PROBE_LOOK_H
#define PROBE_LOOK_H

#include "glowworm_probes.h"

typedef struct gw_probe_texel {
	size_t texel;    /* of all maps, one probe's behind the other's */
	double distance; /* as of gw_probe_look, as are: */
	int32_t probe;
	uint32_t steps;
} gw_probe_texel;

/* As gw_probes_look, by the maps of distances and normals alone. Thread-safe. */
void gw_probes_find(const gw_probes *probes, const double from[3], const float direction[3],
					bool mips, gw_probe_texel *found);

#endif
