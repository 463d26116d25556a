/*
 * gloss_cache.h - radiance caches of glossy pixels, shared by C and GLSL: what a hemisphere holds,
 * and the push-constant block of their passes.
 *
 * A cache is a hemisphere of GW_CACHE_SIDE^2 texels of equal solid angle (hemisphere_map.glsl), and
 * behind it the same ever coarser, each texel the mean of four: from the finest level to a single
 * one. rgb is radiance, w the inverse of the distance that it comes from.
 */
#ifndef GLOSS_CACHE_H
#define GLOSS_CACHE_H

#include "base/shared_math.h"

#define GW_CACHE_SIDE 16u
#define GW_CACHE_LEVELS 5u
#define GW_CACHE_TEXELS 341u /* of all levels */

/* Of a texel of the finest level, steradians. */
#define GW_CACHE_ANGLE (2.0f * GW_PI / 256.0f)

/* A lobe narrower than so many texels is not resolved, and stays with rays. */
#define GW_CACHE_LEAST_LOBE 4.0f

/* Rays a texel of the finest level, two by two, where facets throw the eye's that are turned by
 * less than an angle; else one. Its tangent is this times alpha. */
#define GW_CACHE_RAYS 4u
#define GW_CACHE_TURN 2.0f

/* Caches that a pixel reads, at most, and directions that it looks in. */
#define GW_CACHES_READ 6u
#define GW_CACHE_LOOKS 32u

/* Pixels that show one place share a cache within so many tiles of them. */
#define GW_CACHE_REACH 1.5f

/* The first texel of a level. */
SHARED_FUNCTION(uint) cache_level_first(uint level)
{
	return (1024u - (1024u >> (2u * level))) / 3u;
}

/* Solid angle of the lobe that GGX reflects a ray in that meets it squarely: the inverse of its
 * highest density, that of the facets' normals over 4, where alpha is the square of roughness. */
SHARED_FUNCTION(float) gloss_lobe_angle(float roughness)
{
	return 4.0f * GW_PI * roughness * roughness * roughness * roughness;
}

/* Lengths are in leaf cells, positions in grid coordinates. */
SHARED_STRUCT(gw_cache_push)
{
	uint first, count;
	uint seed;
	uint ray;                   /* which of each texel's */
	uint columns, rows;         /* of tiles */
	uint tile;                  /* pixels a side */
	uint pixel_first;           /* number of the first pixel of this batch */
	vec4 eye;                   /* grid coordinates */
	vec4 sky;                   /* even radiance of what rays see that meet nothing */
	uint sky_width, sky_height; /* of the map, as gw_record_push has it */
	float sky_turn;
	uint sky_y_up;
};
SHARED_SIZE(gw_cache_push, 80);
SHARED_OFFSET(gw_cache_push, eye, 32);
SHARED_OFFSET(gw_cache_push, sky, 48);
SHARED_OFFSET(gw_cache_push, sky_width, 64);

#endif
