/*
 * scan_move.h - a cloud put elsewhere in the scene.
 */
#ifndef SCAN_MOVE_H
#define SCAN_MOVE_H

#include "points/scan.h"

/*
 * Moves a cloud by a matrix: points, which become doubles, normals, axes of splats, scanners and
 * the places of images. Normals keep their length. GW_ERROR_MEMORY.
 *   matrix   row-major, from the file's coordinates to the scene's
 */
gw_status scan_move(scan *cloud, const double matrix[16], gw_error *error);

#endif
