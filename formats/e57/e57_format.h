/*
 * e57_format.h - E57 (ASTM E2807), several scans in one file, each with its pose.
 *
 * Read: every page's checksum; points as cartesian or spherical coordinates; integers, scaled
 * integers and floats of both precisions; all other fields under their names. Records whose
 * invalid state is not 0 are left out and counted. Points are moved by their scan's pose, whose
 * translation is where the scanner stood. Images are not read.
 */
#ifndef E57_FORMAT_H
#define E57_FORMAT_H

#include "points/format.h"
#include "files/input_file.h"

extern const format e57_format;

/* As format.read. */
gw_status e57_read(input_file *in, scan *cloud, gw_error *error);

#endif
