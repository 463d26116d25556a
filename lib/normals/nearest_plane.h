/*
 * nearest_plane.h - the plane through the nearest few neighbours of a surfel. Internal to lib/.
 *
 * Among leaves and wires the neighbours lie on several, and the nearest few of them on one.
 */
#ifndef NEAREST_PLANE_H
#define NEAREST_PLANE_H

#include "cloud/neighbours.h"
#include "normals/plane_normal.h"

/* From this much on of their spread that the plane of all neighbours leaves, planes of few are
 * looked for. */
#define GW_PLANE_UNEVEN 0.02f

/*
 * The neighbours around a surfel, itself first, in units of the furthest one's distance.
 *   point   receives their coordinates
 * Returns how many there are, the surfel itself among them.
 */
size_t gw_places_around(const gw_surfels *surfels, size_t surfel, const gw_neighbour_list *list,
						float point[3 * (GW_NEIGHBOURS + 1)]);

/* Whether points spread in two directions across a normal, rather than along a line: the lesser
 * eigenvalue is more than this share of the greater one. */
bool gw_plane_is_spanned(const float *point, size_t count, const float normal[3], double least);

/*
 * The plane through the first point and the four that are nearest to it.
 *   point   3 * count, the first one at 0
 *   apart   so far off they may be at most
 *   plane   receives its normal, and what of their spread it leaves (plane_normal.h), if there is
 *           one
 * Returns GW_PLANE_NONE where they are fewer or further off, or lie along a line.
 */
gw_plane gw_nearest_plane(const float *point, size_t count, float apart, float plane[4]);

/*
 * The plane through points in which the nearer ones count more, (1 - r^2)^3 at a distance r: over a
 * crease or on rough rock it is nearer to the surface at the first point than that of all alike
 * (weights as of moving least squares, Levin 1998), on a noisy plane it is further off.
 *   point   3 * count, the first one at 0, none further off than about 1
 *   spread  variance of all of them alike, along three axes together, above 0
 *   plane   receives its normal, and the variance that is left across it as a share of `spread`:
 *           on a noisy plane as much as that of all alike leaves of theirs, on the average
 * Returns false where there is none, or the points that count lie along a line.
 */
bool gw_plane_by_nearness(const float *point, size_t count, double spread, float plane[4]);

#endif
