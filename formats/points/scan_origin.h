/*
 * scan_origin.h - where scanners stood: that of a range image, told by its rows and columns, and
 * that of points of which nobody knows more than where they are.
 */
#ifndef SCAN_ORIGIN_H
#define SCAN_ORIGIN_H

#include "points/scan.h"

/*
 * Settles where the scanner of one of a scan's images stood: where the image says, if its rows and
 * columns are seen at even angles from there, or else where they are. Returns whether there is such
 * a place; false also when memory is short.
 */
bool scan_settle_origin(scan *scan, size_t image);

/*
 * Adds the scanner that took all points of a scan without scanners and normals, where the density
 * of its points tells of one (gw_points_find_scanner), and a note that says so. An image of which
 * nobody knows where it was taken from gets the place. GW_ERROR_MEMORY.
 */
gw_status scan_find_origin(scan *scan, gw_error *error);

#endif
