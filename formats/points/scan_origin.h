/*
 * scan_origin.h - where the scanner of a range image stood, told by its rows and columns.
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

#endif
