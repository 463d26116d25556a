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

/* Where the scanner stood that saw all of a scan which comes piece by piece. Zeros begin it. */
typedef struct scan_first_scanner {
	bool looked, known; /* the first piece with points came, and said it */
	double place[3];
} scan_first_scanner;

/*
 * What the first piece with points says of its scanner, the pieces after it say, too.
 *   piece   the first with its scanner, if that is known; others without. GW_ERROR_MEMORY
 */
gw_status scan_keep_scanner(scan_first_scanner *first, scan *piece, gw_error *error);

#endif
