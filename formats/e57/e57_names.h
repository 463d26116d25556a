/*
 * e57_names.h - what columns are called in E57 files.
 *
 * The standard has names for a few, and an extension of its makers for normals. All others stand in
 * an extension of ours, declared in the description: under their own names, of which bytes that
 * names in XML cannot have are written as _x20_.
 */
#ifndef E57_NAMES_H
#define E57_NAMES_H

#include <stdbool.h>

struct scan; /* scan.h */
struct scan_column;

#define E57_OURS "glow"
#define E57_OURS_URI "urn:x-glowworm:e57:columns:1"
#define E57_NORMALS "nor"
#define E57_NORMALS_URI "http://www.libe57.org/E57_NOR_surface_normals.txt"
/* The comments of a cloud, a vector of strings at the root. */
#define E57_COMMENTS E57_OURS ":comments"

/* The name of a field for a column of a cloud, for free(); NULL without memory. */
char *e57_name_write(const struct scan *cloud, const struct scan_column *column);

/* The column's name of a field of our extension, for free(). *ours: whether it is one; NULL where
 * it is none, and without memory. */
char *e57_name_read(const char *field, bool *ours);

#endif
