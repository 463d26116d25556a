/*
 * peer_cycles.h - the discs of a cloud lit by Cycles, in Blender.
 *
 * Cycles has no discs. Each becomes a polygon, cut half-way to its neighbours: as discs overlap,
 * what emits would be counted more than once, and rays that begin on one would meet others there.
 */
#ifndef PEER_CYCLES_H
#define PEER_CYCLES_H

#include "peer_discs.h"

typedef struct peer_cycles {
	char *folder; /* of files on the way to and from Blender */
	char *polygons, *light;
	const char *script, *scene; /* peer_cycles.py, and where the lamps are; borrowed */
	size_t count;
} peer_cycles;

/*
 * Cuts the polygons and writes them for Blender; cleared with peer_cycles_clear, which removes
 * them.
 *   discs   not indexed; receive neighbours
 */
gw_status peer_cycles_make(peer_discs *discs, const char *script, const char *scene,
						   peer_cycles *cycles, gw_error *error);
void peer_cycles_clear(peer_cycles *cycles);

/*
 * Path tracing in a process of Blender's own.
 *   samples     paths of every surfel
 *   irradiance  receives 3 a surfel
 *   seconds     receives those by the clock and of the processor from arrays of polygons to one of
 *               light, without Blender's start and files
 */
gw_status peer_cycles_light(const peer_cycles *cycles, uint32_t samples, float *irradiance,
							double seconds[2], gw_error *error);

#endif
