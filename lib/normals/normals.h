/* normals.h - normals for surfels that came without. Internal to lib/. */
#ifndef NORMALS_H
#define NORMALS_H

#include "cloud/neighbours.h"

/*
 * Estimates normals that are 0, 0, 0, orients them, and those of no side, and sets two_sided where
 * they cannot be trusted. A normal is that of the plane through the neighbours or, near creases, of
 * a neighbour's plane that the surfel lies on and that is of one face alone; on leaves and wires,
 * of which rows and columns of a scan tell, that of the plane through a few neighbours.
 * Orientation: to the scanner that saw it. Where nobody knows which of several that was, and
 * without scanners, as normal_orientation.h says.
 */
gw_status gw_normals_complete(const gw_points *points, const gw_surfels_options *options,
							  gw_neighbours *search, gw_surfels *surfels, gw_error *error);

/* Does anybody know which scanner saw which point, so that normals that are missing are turned to
 * it? */
bool gw_normals_face_scanner(const gw_points *points);

#endif
