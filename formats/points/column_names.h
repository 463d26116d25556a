/*
 * column_names.h - the names that other programs give to columns, and ours.
 */
#ifndef COLUMN_NAMES_H
#define COLUMN_NAMES_H

/* The canonical name for one that is spelled out (normal_x, diffuse_red, X), in any case; the name
 * itself when it is not known. */
const char *column_canonical_name(const char *name);

/* The same, and names as tables have them in their first line: i, Easting, Normal X. */
const char *column_table_name(const char *name);

#endif
