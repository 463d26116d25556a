/*
 * mesh_sample.h - places on a mesh of triangles, spread evenly over its area.
 *
 * The areas of the triangles, one behind the other, make an interval. It is cut into as many equal
 * strata as there are samples, and each stratum holds one sample at a random place. Where in its
 * triangle the sample falls is the first of two numbers in [0, 1), its index times the golden ratio
 * the second; Turk's formula makes a place of both. So a triangle that holds many samples holds a
 * Kronecker lattice: no clumps, no holes, whatever the triangle's shape, because the golden ratio's
 * lattice stays even when one axis is stretched. And the number of samples on any run of triangles
 * differs from density times area by less than two.
 *
 * Source: G. Turk, Generating random points in triangles, 1990, as used by Mavridis and
 * Papaioannou, Global Illumination using Imperfect Volumes, section 3.1.
 */
#ifndef MESH_SAMPLE_H
#define MESH_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

/* A place on a mesh: the weights of the triangle's corners, each 0..1, with a sum of 1. */
typedef struct gw_mesh_place {
	size_t triangle;
	double weight[3];
} gw_mesh_place;

/*
 * Sums the triangles' areas.
 *   position     3 * number of vertices, metres
 *   corner       3 * triangles, indices of vertices, all of them valid
 *   sum          triangles; receives the area of all triangles up to this one, m^2. A triangle
 *                without area adds nothing: its corners lie on a line as far as doubles can tell,
 *                or one of them is not finite
 *   degenerate   receives how many such triangles there are
 * Returns the total area; infinite when a double cannot hold it. Thread-safe.
 */
double gw_mesh_areas(const double *position, const uint32_t *corner, size_t triangles, double *sum,
					 size_t *degenerate);

/*
 * Sample `index` of `count`. The same arguments give the same place, so samples may be computed in
 * any order, by any number of threads.
 *   sum         from gw_mesh_areas; the last one is finite and above 0
 *   triangles   at least 1
 *   index       below count
 */
gw_mesh_place gw_mesh_place_of(const double *sum, size_t triangles, uint64_t count, uint64_t seed,
							   uint64_t index);

/* Normal of a triangle, counter-clockwise corners; its length is twice the area. */
void gw_mesh_cross(const double *position, const uint32_t corner[3], double normal[3]);

#endif
