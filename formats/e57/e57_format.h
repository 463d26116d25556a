/*
 * e57_format.h - E57 (ASTM E2807), several scans in one file, each with its pose.
 *
 * Read: every page's checksum; points as cartesian or spherical coordinates; integers, scaled
 * integers and floats of both precisions; all other fields under their names. Records whose
 * invalid state is not 0 are left out and counted. Points are moved by their scan's pose, whose
 * translation is where the scanner stood. Images are not read.
 *
 * Written: a scan for each scanner of which it is known what it saw, with its place as pose and the
 * points in their order; integers in the bits that they need, colours of 8 bits in 8, floats as
 * they are, rows and columns of range images. Columns that the standard has no names for, and
 * comments, stand in an extension of ours (e57_names.h) and are read again.
 */
#ifndef E57_FORMAT_H
#define E57_FORMAT_H

#include "points/format.h"
#include "files/input_file.h"
#include "files/output_file.h"

extern const format e57_format;
extern const format_parted e57_parted; /* all as one scan */

/* As format.read and format.write. */
gw_status e57_read(input_file *in, scan *cloud, gw_error *error);
gw_status e57_write(output_file *out, const scan *cloud, gw_error *error);

#endif
