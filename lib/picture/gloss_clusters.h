/*
 * gloss_clusters.h - place step of gloss caches: pixels that can share what one of them sees
 * (Rehfeld, Zirr and Dachsbacher 2014, Clustered Pre-convolved Radiance Caching, 3.2).
 *
 * The picture is cut into square tiles. Pixels of a tile are one cluster if they lie at about the
 * same distance and their normals are best described by the same one of the tile's three axes. The
 * axes are chosen one after the other from a blurred histogram of the tile's normals, as w, which
 * is how many pixels have about a normal n, with w = (w + 1) (1 - |n . n_best|^8) after each
 * choice.
 */
#ifndef GLOSS_CLUSTERS_H
#define GLOSS_CLUSTERS_H

#include "glowworm_picture.h"

/* Pixels a side of a tile, unless that makes too many clusters. */
#define GW_GLOSS_TILE 16u

/* No cluster: a pixel whose lobe is too narrow for a cache. */
#define GW_NO_CLUSTER UINT32_MAX

/* Whether a cache resolves the lobe of a surface. */
bool gw_gloss_is_cached(float roughness);

typedef struct gw_gloss_clusters {
	uint32_t tile, columns, rows; /* pixels a side; tiles */
	size_t count;
	uint32_t *tile_first;     /* columns * rows + 1: the first cluster of each */
	uint32_t *representative; /* count: the pixel that speaks for it */
	uint32_t *cluster_of;     /* pixels->count, or GW_NO_CLUSTER */
} gw_gloss_clusters;

/*
 * Finds the clusters of pixels whose lobe a cache resolves.
 *   pixels     with places
 *   most       clusters; tiles are made larger until there are no more
 *   clusters   on success cleared with gw_gloss_clusters_clear; zeroed on failure
 * GW_ERROR_MEMORY.
 */
gw_status gw_gloss_clusters_make(const gw_pixels *pixels, size_t most, gw_gloss_clusters *clusters,
								 gw_error *error);
void gw_gloss_clusters_clear(gw_gloss_clusters *clusters);

#endif
