/*
 * far_points.h - what lies beyond a tile: of the points that were kept of the whole cloud those
 * that are far away taken together, the more the farther they are.
 *
 * What is seen from afar is small, and its light comes from many places at once: points that fill
 * one cube, and face one of its six sides, become one of them, with their mean albedo and their
 * mean light, where the cube takes no more than 1/16 in angle seen from the tile (Barnes and Hut
 * 1986 choose cells so). Cubes are as wide as the spacing of the points that were kept, times
 * powers of two, so that from tile to tile they are the same.
 *
 * Shadows have edges, which a coarse surface would misplace: what stands between the tile and a
 * lamp or the sun stays as it was kept, and so do lamps that are made of points.
 */
#ifndef FAR_POINTS_H
#define FAR_POINTS_H

#include "bake/point_subset.h"
#include "glowworm_parts.h"

typedef struct gw_far_points {
	gw_point_subset subset; /* of the points that were kept; albedo, emission and opacity are means
							   of those that each point stands for */
	/* 3 each: their irradiance, W/m^2; */
	float *all;
	float **lamp; /* lamps: of each light alone, */
	size_t lamps;
	float *rest; /* and of what emits; NULL: nothing does */
} gw_far_points;

/*
 * Finds what lies beyond a tile.
 *   far   to be freed with gw_far_points_clear, also on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_far_points_make(const gw_tile *tile, const gw_tile_lighting *lighting,
							 gw_far_points *far, gw_error *error);
void gw_far_points_clear(gw_far_points *far);

#endif
