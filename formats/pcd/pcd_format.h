/*
 * pcd_format.h - PCD, the format of the Point Cloud Library.
 *
 * Read in full: ascii, binary and binary_compressed (LZF), fields of every type, size and count;
 * fields called _ are padding. A field of several values becomes a column for each, NAME_0 and so
 * on; 64-bit integers become doubles; packed rgb and rgba become red, green, blue and alpha. POINTS
 * counts, not WIDTH and HEIGHT, but the file must hold as many. The viewpoint is where the scanner
 * stood, unless it is the one that programs write when they do not know.
 *
 * Written as binary, with colours of 8 bits packed as rgb, and coordinates in single precision when
 * that holds every one of them: programs that use PCL take doubles for zeros. Organised where all
 * points are one picture.
 */
#ifndef PCD_FORMAT_H
#define PCD_FORMAT_H

#include "points/format.h"
#include "files/input_file.h"
#include "files/output_file.h"

extern const format pcd_format;
extern const format_parted pcd_parted; /* all as a list */

/* As format.read and format.write. */
gw_status pcd_read(input_file *in, scan *cloud, gw_error *error);
gw_status pcd_write(output_file *out, const scan *cloud, gw_error *error);

/* Whether all points are one picture, every cell of it in order, row after row: an organised cloud,
 * as which it is written. */
bool pcd_is_picture(const scan *cloud);

#endif
