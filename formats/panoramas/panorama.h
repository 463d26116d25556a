/*
 * panorama.h - maps of the environment: pictures of all directions by longitude and latitude, twice
 * as wide as high, as OpenEXR or Radiance HDR files. What direction a pixel is, see gw_light.
 */
#ifndef PANORAMA_H
#define PANORAMA_H

#include "files/input_file.h"

/* Pixels of the largest map that is read: 16384 x 8192. */
#define PANORAMA_PIXELS ((uint64_t)1 << 27)

typedef struct panorama {
	uint32_t width, height;
	float *pixels; /* owned; 3 * width * height, rows from the top; linear RGB as in the file */
} panorama;

/* Frees the pixels and empties the map. */
void panorama_clear(panorama *map);

/* Read the one format and the other, from bytes; panorama_reader.h finds out which it is. */
gw_status panorama_hdr_read(const input_file *in, panorama *map, gw_error *error);
gw_status panorama_exr_read(const input_file *in, panorama *map, gw_error *error);

/* Version of the library that reads OpenEXR files. */
void panorama_openexr_version(int version[3]);

/* Pixels that are compressed by DWA, into a map that has the size of the picture's data window.
 * rgb: they are in R, G and B, else Y goes to the first of three. */
gw_status panorama_dwa_pixels(const input_file *in, bool rgb, panorama *map, gw_error *error);

/* Allocates the pixels of a map, whose sides a header gives. GW_ERROR_DATA when they are not those
 * of a panorama, or more than PANORAMA_PIXELS, or more than `most` that the bytes can hold. */
gw_status panorama_allocate(const input_file *in, uint64_t width, uint64_t height, uint64_t most,
							panorama *map, gw_error *error);

#endif
