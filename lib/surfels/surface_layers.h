/*
 * surface_layers.h - whether surface lies in layers, as where several scans of a place are off
 * against each other by as much as their points are apart. Internal to lib/.
 *
 * A plane through a dozen neighbours then goes anywhere. With points joined (near_duplicates.h) the
 * layers are thin for the distance between those that are left, and become one; what is finer than
 * the scans agree on nobody knows anyway. What fills space, as leaves do, stays as thick as it was,
 * in distances between points, whatever is joined.
 */
#ifndef SURFACE_LAYERS_H
#define SURFACE_LAYERS_H

#include "cloud/neighbours.h"

/* Median thickness (filled_space.h) of the surface, of some hundred places. */
double gw_surface_thickness(const gw_surfels *surfels, gw_neighbours *search);

#endif
