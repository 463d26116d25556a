/*
 * polar_picture.h - the light of a luminaire as lighting designers draw it: how far from the middle
 * its curves are is the intensity in that direction, straight down below.
 */
#ifndef POLAR_PICTURE_H
#define POLAR_PICTURE_H

#include "files/output_file.h"
#include "luminaires/luminaire.h"

/* Pixels a side. */
#define POLAR_PICTURE 640u

/*
 * Draw a luminaire and write it: the planes C 0 (right) and 180 in red, C 90 and 270 in blue; rays
 * each 30 degrees, rings at quarters of the largest intensity, which reaches the outermost.
 * GW_ERROR_MEMORY, or as png_picture_write and exr_picture_write.
 */
gw_status polar_picture_write_png(output_file *out, const luminaire *l, gw_error *error);
gw_status polar_picture_write_exr(output_file *out, const luminaire *l, gw_error *error);

#endif
