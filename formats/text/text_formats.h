/*
 * text_formats.h - point clouds as tables of text: XYZ and its like, CSV, PTS, PTX.
 *
 * Coordinates become doubles; every other column the smallest type that holds all its numbers as
 * they were written.
 *
 * XYZ (.xyz .txt .asc .csv): one point a line, columns parted by blanks, commas or semicolons. The
 * names come from format_options.columns, else from a first line of names (a comment too), else
 * from what the values look like: normals have a length of 1, colours are whole numbers up to 255.
 * Rows that have more values than a first line has names are left out and counted.
 *
 * PTS: counts on lines of their own or none; x y z, intensity, red green blue.
 *
 * PTX: one grid or more of a scanner, each with its size, position and matrix; x y z intensity and
 * often red green blue in the scanner's frame. Points are moved by the matrix; cells without a
 * return (0 0 0) are left out and counted.
 */
#ifndef TEXT_FORMATS_H
#define TEXT_FORMATS_H

#include "points/format.h"
#include "files/input_file.h"
#include "files/output_file.h"

extern const format xyz_format, csv_format, pts_format, ptx_format;

/* As format.read. */
gw_status xyz_read(input_file *in, scan *cloud, gw_error *error);
gw_status pts_read(input_file *in, scan *cloud, gw_error *error);
gw_status ptx_read(input_file *in, scan *cloud, gw_error *error);

/*
 * As format.write: a line a point, in the shortest digits that give the same numbers back. XYZ has
 * blanks between them, and before them comments and, unless there is nothing but x y z, names, on
 * lines that begin with #; CSV has commas and a first line of names.
 */
gw_status xyz_write(output_file *out, const scan *cloud, gw_error *error);
gw_status csv_write(output_file *out, const scan *cloud, gw_error *error);

/* The same part by part: lines hang on nothing but their points. */
extern const format_parted xyz_parted, csv_parted;

#endif
