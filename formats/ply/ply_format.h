/*
 * ply_format.h - PLY, the polygon file format: its points only.
 *
 * Read in full: ascii and both binary orders, every scalar type under both of its names, properties
 * in any order, lists and other elements skipped, lines that end in LF, CRLF or CR. Written as
 * binary little-endian, columns in the scan's order. Gaussian splats become points (ply_splats.h).
 */
#ifndef PLY_FORMAT_H
#define PLY_FORMAT_H

#include "points/format.h"
#include "files/input_file.h"
#include "files/output_file.h"

extern const format ply_format;

/* As format.read and format.write. Known names (diffuse_red, normal_x, X) become the canonical
 * ones. A file that counts zero vertices gives a scan of no points. */
gw_status ply_read(input_file *in, scan *cloud, gw_error *error);
gw_status ply_write(output_file *out, const scan *cloud, gw_error *error);

/* As format.count_rows and its fellows. Vertices are read in parts where they are binary and have
 * no lists, and no colours that may be packed into one value. */
uint64_t ply_count_rows(input_file *in, uint64_t *together);
gw_status ply_read_rows(input_file *in, const format_rows *rows, scan *cloud, gw_error *error);
gw_status ply_write_head(output_file *out, const format_whole *whole, const scan *cloud,
						 gw_error *error);
gw_status ply_write_rows(output_file *out, const format_whole *whole, const scan *cloud,
						 gw_error *error);

#endif
