/*
 * panorama_files.h - small maps of the sky as files: 16 x 8 pixels, of which pixel i has red i,
 * green 2 i and blue 0.25, before the rounding of the format.
 */
#ifndef PANORAMA_FILES_H
#define PANORAMA_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PANORAMA_FILE_W = 16, PANORAMA_FILE_H = 8, PANORAMA_FILE_ROOM = 8192 };

/* Writes a Radiance HDR file, run-length encoded or flat. Returns its length. */
size_t panorama_file_hdr(bool runs, uint8_t file[PANORAMA_FILE_ROOM]);

/* The same as OpenEXR, by this program's own writer. grey: one channel Y, which is red. */
size_t panorama_file_exr(bool grey, uint8_t file[PANORAMA_FILE_ROOM]);

/* The same as OpenEXR in tiles of 10 x 5 pixels, by OpenEXRCore. */
size_t panorama_file_tiles(uint8_t file[PANORAMA_FILE_ROOM]);

/* The same as OpenEXR, compressed by DWA as its library wrote it: floats lose nothing. */
size_t panorama_file_dwa(uint8_t file[PANORAMA_FILE_ROOM]);

#endif
