/*
 * gloss_filter.h - less noise in what rough pixels reflect: each takes the mean over its neighbours
 * on the same surface.
 */
#ifndef GLOSS_FILTER_H
#define GLOSS_FILTER_H

#include "glowworm_picture.h"

/* Pixels of a picture that have a reflection. */
typedef struct gloss_picture {
	const gw_pixels *pixels;
	const size_t *place; /* pixels->count: where each stands in the picture, ascending */
	uint32_t width, height;
} gloss_picture;

/*
 * Smooths reflections within a picture. The reach grows with the roughness, from none at 0.2 to
 * four pixels at 0.5, and falls with the number of rays, so that more rays still come nearer to the
 * truth.
 *   rays        of a pixel
 *   reflected   4 * pixels->count, as of gw_render_octree_reflect; shares stay
 * GW_ERROR_MEMORY.
 */
gw_status gloss_filter_apply(const gloss_picture *picture, uint32_t rays, float *reflected,
							 gw_error *error);

#endif
