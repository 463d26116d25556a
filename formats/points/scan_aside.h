/*
 * scan_aside.h - columns that say again what the points of a scan hold are put aside for the time
 * of a bake: half of a file's bytes, where it has coordinates, normals and emission.
 */
#ifndef SCAN_ASIDE_H
#define SCAN_ASIDE_H

#include "points/scan.h"

/* Gives the values of such columns back: their data is NULL until scan_take_back. Only of columns
 * of float32 and float64 whose values come out of the points to the last bit. */
void scan_put_aside(scan *cloud, const scan_points *points);

/* Makes them again of the same points. GW_ERROR_MEMORY. */
gw_status scan_take_back(scan *cloud, const scan_points *points, gw_error *error);

#endif
