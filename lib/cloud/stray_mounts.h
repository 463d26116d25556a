/*
 * stray_mounts.h - what a scanner stood on, as it saw it itself: a plate, a tripod's head, a
 * robot's back. Internal to lib/.
 *
 * It is no part of what was scanned, and as surface it would shade a lamp that is put where the
 * scanner stood, and all below. It is near: within a metre, and 0.4 of how far half of the
 * scanner's points are off. It lies on all sides of its middle. It stands alone: beside most of its
 * outline the scanner sees what is far behind it, while walls, floors and tables go on there. And
 * it is beneath the scanner, or above it, or no further off than a plate: a door's jamb is beside.
 */
#ifndef STRAY_MOUNTS_H
#define STRAY_MOUNTS_H

#include "glowworm.h"

/*
 * Finds the points of mounts. Scanners that saw less than some thousands of points, and more than a
 * few dozens of scanners, which one is that moves, are not looked at, nor are points of which
 * nobody knows which of several scanners saw them.
 *   found  receives one a point, 1: of a mount, for free(); NULL where there is none
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_stray_mounts_find(const gw_points *points, uint8_t **found, gw_error *error);

#endif
