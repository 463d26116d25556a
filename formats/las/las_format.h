/*
 * las_format.h - LAS, LAZ and COPC, the ASPRS formats of laser scans.
 *
 * Read: versions 1.0 to 1.5, point formats 0 to 10, extra bytes of all types; LAZ of every
 * compressor that LASzip has (laz_reader.h). Written: LAS 1.4, also as LAZ
 * and COPC.
 *
 * Every field is a column under its name in lower case (intensity, return_number, gps_time, nir,
 * wave_offset ...), extra bytes under their own. Flags and colours that are 0 at all points are no
 * column. The grid of the coordinates and the coordinate system are comments (las_notes.h).
 */
#ifndef LAS_FORMAT_H
#define LAS_FORMAT_H

#include "points/format.h"
#include "files/input_file.h"
#include "files/output_file.h"

extern const format las_format, laz_format, copc_format;
extern const format_parted las_parted, laz_parted;

/* As format.read, for all. */
gw_status las_read(input_file *in, scan *cloud, gw_error *error);

/* As format.count_rows and its fellows. Points are read in parts unless some field's column hangs
 * on all of its values, as that of integers of 64 bits does. */
uint64_t las_count_rows(input_file *in, uint64_t *together);
bool las_say_bounds(input_file *in, double minimum[3], double maximum[3]);
gw_status las_read_rows(input_file *in, const format_rows *rows, scan *cloud, gw_error *error);
gw_status las_settle_rows(input_file *in, const format_seen *seen, scan *kept, gw_error *error);

/*
 * As format.write: LAS 1.4, to files and pipes.
 *
 * Columns called like fields go to those fields when they hold every value exactly, all others to
 * extra bytes. Colours become 16 bits. Coordinates lie on the grid that the scan's comments name
 * when that gives them back bit for bit; else on the coarsest decimal grid that does; else on the
 * finest that 32 bits reach. Where columns of formats 0 to 5 go to a newer one, class 12, overlap,
 * becomes the flag and class 0. A step over a millimetre is refused, as are coordinates that are no
 * numbers and more columns than a record holds.
 */
gw_status las_write(output_file *out, const scan *cloud, gw_error *error);

/* The same points, compressed by chunks on several threads (laz_chunks.h). Memory holds some chunks
 * for each of them; of what goes to a pipe all. The bytes are the same for any number of threads,
 * in a file and in a pipe. */
gw_status laz_write(output_file *out, const scan *cloud, gw_error *error);

/* COPC 1.0: LAZ whose chunks are nodes of an octree, each a thinned cloud of what its cube holds
 * (copc_tree.h), so that a viewer loads what it shows. The points' order is the nodes'. Formats 6
 * to 8 only. Memory holds the compressed file, and some 40 bytes a point beside it. */
gw_status copc_write(output_file *out, const scan *cloud, gw_error *error);

#endif
