/*
 * pcl_loaders.h - the loaders of the Point Cloud Library, for benchmarks.
 */
#ifndef PCL_LOADERS_H
#define PCL_LOADERS_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a PLY, PCD or OBJ file, told apart by the extension, into PCL's untyped cloud, which costs
 * it least. Returns the number of points, or 0 when PCL has no loader or it fails. */
size_t pcl_load(const char *path);

/* Saves a PCD file again as text or compressed. False when that fails. */
bool pcl_save_text(const char *from, const char *to);
bool pcl_save_compressed(const char *from, const char *to);

#ifdef __cplusplus
}
#endif

#endif
