/*
 * cloud_format.h - .cloud, the format of Salm's thesis (section 5.2): an int32 count, then for each
 * sample position 3 x float32, NDF 3 x float32, albedo 3 x uint8 (sRGB); 27 bytes, little-endian,
 * right-handed with y up.
 */
#ifndef CLOUD_FORMAT_H
#define CLOUD_FORMAT_H

#include "points/format.h"
#include "files/input_file.h"
#include "files/output_file.h"

extern const format cloud_format;

/* As format.read. The columns are x y z nx ny nz red green blue. */
gw_status cloud_read(input_file *in, scan *cloud, gw_error *error);

/* As format.count_rows and format.read_rows. */
uint64_t cloud_count_rows(input_file *in, uint64_t *together);
gw_status cloud_read_rows(input_file *in, const format_rows *rows, scan *cloud, gw_error *error);

/*
 * As format.write. A scan with z up is turned so that y is up. Missing normals become zeros and
 * missing colours the grey of GW_ALBEDO_DEFAULT; other columns have no place in this format.
 * Refuses more than 2^31 - 1 points and coordinates that would move by over 1 mm in float32.
 */
gw_status cloud_write(output_file *out, const scan *cloud, gw_error *error);

#endif
