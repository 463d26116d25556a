/*
 * gloss_caches.h - radiance caches that rough pixels share (Rehfeld, Zirr and Dachsbacher 2014):
 * placed in clusters of pixels (gloss_clusters.h), filled by a few rays a texel, and read by each
 * pixel from those near by. shaders/picture/gloss_cache.h says what a cache is.
 */
#ifndef GLOSS_CACHES_H
#define GLOSS_CACHES_H

#include "picture/render_octree.h"

/* Caches, filled. Zeroed: none. */
typedef struct gw_gloss_caches {
	uint32_t count;
	uint32_t tile, columns, rows; /* pixels a side; tiles of the picture */
	gw_buffer tile_first;         /* uint a tile, and one more: its first cache */
	gw_buffer place, facing;      /* vec4 a cache: grid coordinates and reach; normal, roughness */
	gw_buffer pixel;              /* uint a cache: where it is in the picture */
	gw_buffer texel;              /* vec4, GW_CACHE_TEXELS a cache */
	gw_buffer screen;             /* uvec2 a pixel that reads them: place; cache of its cluster */
	uint32_t *reader;             /* owned; reader_count: the pixels that do, ascending */
	size_t reader_count;
} gw_gloss_caches;

/*
 * Places caches for the pixels whose lobes they resolve, and fills them.
 *   caches   on success destroyed with gw_gloss_caches_destroy; zeroed on failure
 * Fails with GW_ERROR_USAGE when the pixels have no places in a picture, GW_ERROR_MEMORY.
 */
gw_status gw_gloss_caches_make(gw_render_octree *octree, const gw_pixels *pixels,
							   const gw_reflection *reflection, gw_gloss_caches *caches,
							   gw_error *error);
void gw_gloss_caches_destroy(gw_gpu *gpu, gw_gloss_caches *caches);

/* What passes of caches are told; which pixels these are is left 0. */
gw_cache_push gw_gloss_caches_push(const gw_render_octree *octree, const gw_gloss_caches *caches,
								   const gw_pixels *pixels, const gw_reflection *reflection);

#endif
