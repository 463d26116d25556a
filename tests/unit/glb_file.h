/*
 * glb_file.h - small binary glTF files, made of their JSON and their numbers.
 */
#ifndef GLB_FILE_H
#define GLB_FILE_H

#include <stddef.h>
#include <stdint.h>

enum { GLB_FILE_ROOM = 4096 };

/*
 * Puts chunks together: JSON filled up with blanks, then the binary one unless `bytes` is NULL.
 * Returns the file's length.
 */
size_t glb_file_make(const char *json, const void *bytes, size_t length,
					 uint8_t file[GLB_FILE_ROOM]);

/*
 * A square of two indexed triangles, 1 m long, in the plane z = 0, with normals and colours in
 * bytes, placed twice: by a matrix that mirrors at x = 0, and turned by 90 degrees about x, twice
 * as large, one metre along y. Beside it a triangle without indices that emits 5, 2.5, 0.
 */
size_t glb_file_square(uint8_t file[GLB_FILE_ROOM]);

#endif
