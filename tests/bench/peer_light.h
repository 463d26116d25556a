/*
 * peer_light.h - two usual ways to light the discs of a cloud: paths, and rays that read a cache.
 *
 * Both find irradiance at every surfel and use all processors.
 */
#ifndef PEER_LIGHT_H
#define PEER_LIGHT_H

#include "peer_discs.h"

/* Irradiance straight from lamps and sun at every surfel into 3 * count numbers; `samples` of
 * them where lamps are soft, one where they are not. */
void peer_light_lamps(const peer_discs *discs, uint32_t samples, float *irradiance);

/*
 * Path tracing: adds `samples` paths of every surfel to 3 * count sums, of light that does not come
 * straight from lamps. Each vertex aims at the lamps and at one place of the emitters, weighed
 * against what is met by chance; from the third on, paths end by Russian roulette. The first
 * vertex's directions are a low-discrepancy sequence that goes on from sample `first`.
 */
void peer_light_paths(const peer_discs *discs, uint32_t first, uint32_t samples, float *sum);

/*
 * Cached radiance: every surfel traces `rays` rays once and keeps what they meet; then each bounce
 * reads the radiance that the surfels met have from the one before, until a bounce adds less than
 * a thousandth. `rays` places of the emitters are aimed at as well.
 *   lamps       3 * count, of peer_light_lamps
 *   irradiance  receives 3 * count numbers, without the lamps' own
 */
gw_status peer_light_cached(const peer_discs *discs, uint32_t rays, const float *lamps,
							float *irradiance, gw_error *error);

/* Replaces irradiance by a mean over a surfel's neighbours, weighed by distance, by how alike
 * normals are, and by distance from the surfel's plane. GW_ERROR_MEMORY. */
gw_status peer_light_filter(const peer_discs *discs, float *irradiance, gw_error *error);

#endif
