/*
 * peer_discs.h - the discs of a cloud in Embree, for programs that the bake is measured against.
 *
 * The discs are those that the bake itself uses (surfels.h), cut at edges as there, so that what
 * differs is how light is found. Discs overlap: what a ray meets is the surfel whose centre is
 * nearest to the place it hits. Backs are black.
 */
#ifndef PEER_DISCS_H
#define PEER_DISCS_H

#include "cloud/surfels.h"

#include <embree3/rtcore.h>

/* Neighbours of a surfel, itself among them, for rays and filters. */
#define PEER_NEIGHBOURS 16u

/* Rays begin this far above the surface, and end as far above what they aim at, in spacings. */
#define PEER_OFFSET 0.2f

#define PEER_NOTHING UINT32_MAX

typedef struct peer_discs {
	gw_surfels surfels;
	const gw_light *lights; /* borrowed; light_count */
	size_t light_count;
	float *frame;        /* 6 a surfel: the two axes of its plane */
	uint32_t *neighbour; /* `neighbours` a surfel, itself among them, nearest first */
	size_t neighbours;
	RTCDevice device;
	RTCScene scene;
	uint32_t *emitter; /* emitter_count surfels that emit */
	float *chance;     /* emitter_count, cumulative share of the emitted light; the last is 1 */
	float *density;    /* one a surfel: probability of being aimed at, a square metre */
	size_t emitter_count;
	float sky[3];
	bool soft; /* a lamp has a size, so that its shadow is drawn at random */
} peer_discs;

/* Random numbers of one point (PCG-like; O'Neill 2014). */
typedef struct peer_random {
	uint64_t state;
} peer_random;

float peer_random_next(peer_random *random);

/*
 * Makes the discs of a cloud on all processors; freed with peer_discs_clear.
 *   lights  borrowed as long as the discs live
 */
gw_status peer_discs_make(const gw_points *points, const gw_light *lights, size_t light_count,
						  peer_discs *discs, gw_error *error);
void peer_discs_clear(peer_discs *discs);

/* Finds so many neighbours of each surfel. GW_ERROR_MEMORY. */
gw_status peer_discs_neighbours(peer_discs *discs, size_t neighbours, gw_error *error);

/* Neighbours, and what Embree needs: before rays are traced, or light filtered. */
gw_status peer_discs_index(peer_discs *discs, gw_error *error);

/* Do two surfels face alike, so that they may be one surface? */
bool peer_discs_alike(const peer_discs *discs, size_t i, size_t j);

/* The surfel that a ray from a surfel meets from its front: PEER_NOTHING where it leaves the scene,
 * PEER_BACK where it meets a back. distance: receives how far, unless nothing is met. */
#define PEER_BACK (UINT32_MAX - 1)
uint32_t peer_trace(const peer_discs *discs, uint32_t from, const float direction[3],
					float *distance);

/* A cosine-distributed direction about a surfel's normal, from two numbers in [0, 1). */
void peer_cosine_direction(const peer_discs *discs, uint32_t surfel, float u, float v,
						   float direction[3]);

/* Adds the irradiance straight from lamps and sun at a surfel. */
void peer_add_lamps(const peer_discs *discs, uint32_t surfel, peer_random *random,
					float irradiance[3]);

/*
 * Adds the irradiance of one place on an emitter, drawn by three numbers in [0, 1), weighed by the
 * balance heuristic (Veach 1997) against `others` cosine-distributed rays for each such place.
 */
void peer_add_emitter(const peer_discs *discs, uint32_t surfel, const float drawn[3], float others,
					  float irradiance[3]);

/* The weight of an emitter that a cosine-distributed ray met by chance; the other part. */
float peer_met_weight(const peer_discs *discs, uint32_t from, uint32_t met,
					  const float direction[3], float distance, float others);

#endif
