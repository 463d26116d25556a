/*
 * laz_clouds.h - clouds for tests of LAZ and COPC files, written and read again.
 */
#ifndef LAZ_CLOUDS_H
#define LAZ_CLOUDS_H

#include "files/output_file.h"
#include "points/format.h"

/* A value of point i. */
typedef double cloud_value(size_t i);

/* In [0, 1), without any order. */
double hashed(size_t i, uint64_t salt);

/* Adds a column. */
void add_values(scan *cloud, const char *name, scan_type type, cloud_value *value);

/* Coordinates and intensity: a scanner's lines on a wavy floor in steps of a millimetre; or wild:
 * anywhere that 32 bits of millimetres reach, so that differences go round. */
scan make_cloud(size_t count, bool wild);

/* Red, green and blue; near-infrared; times, returns, channels, flags, classes, angles of pulses,
 * whose times are steady or leap; columns of all types that are no fields of LAS. */
void add_colors(scan *cloud);
void add_infrared(scan *cloud);
void add_pulses(scan *cloud, bool wild);
void add_extra(scan *cloud);

/* What an old point format has in place of scan_angle. */
void add_rank(scan *cloud);

/* Writes and reads files; a failure fails the test. */
void write_cloud(const format *f, const char *path, const scan *cloud);
scan read_cloud(const char *path);

/* A file's bytes, for free(). */
uint8_t *load_bytes(const char *path, size_t *length);

/* Writes a cloud with one processor and with all; the bytes have to be the same. */
void same_by_one_processor(const format *f, const char *path, const scan *cloud);

#endif
