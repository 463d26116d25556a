/*
 * octree_points.h - surfels made up for tests and benchmarks of the octree.
 */
#ifndef OCTREE_POINTS_H
#define OCTREE_POINTS_H

#include "cloud/surfels.h"

/* A number in [0, 1) that follows from the state. */
double octree_points_random(uint64_t *state);

/*
 * Random surfels on the unit sphere, normals outwards: equal shares of the surface, discs of the
 * mean distance of the 8th neighbour, RoI as if points were evenly spread; albedo follows the
 * position. Freed with gw_surfels_clear; false when memory is short.
 */
bool octree_points_sphere(size_t count, uint64_t seed, gw_surfels *surfels);

/* Allocates zeroed surfels with unit normals (0, 0, 1). */
bool octree_points_make(size_t count, bool emission, gw_surfels *surfels);

/* Sets the bounds from the positions. */
void octree_points_bound(gw_surfels *surfels);

#endif
