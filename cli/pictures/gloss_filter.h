/*
 * gloss_filter.h - less noise in what rough pixels reflect: each takes the mean over its neighbours
 * on the same surface.
 */
#ifndef GLOSS_FILTER_H
#define GLOSS_FILTER_H

#include "glowworm_picture.h"

/*
 * Smooths reflections within a picture. The reach grows with the roughness, from none at 0.2 to
 * four pixels at 0.5, and falls with the number of rays, so that more rays still come nearer to the
 * truth.
 *   pixels      with places
 *   reflection  how they were found
 *   reflected   4 * pixels->count, as of gw_render_octree_reflect; shares stay
 * GW_ERROR_MEMORY.
 */
gw_status gloss_filter_apply(const gw_pixels *pixels, const gw_reflection *reflection,
							 float *reflected, gw_error *error);

#endif
