/*
 * scan_splats.h - what splats know of surfaces, in columns of a scan.
 */
#ifndef SCAN_SPLATS_H
#define SCAN_SPLATS_H

#include "points/scan.h"

/* How opaque the middle of a splat is, 0..1. Many lie over each other, and together they are opaque
 * where a surface is: so this is no opacity of points. */
#define SCAN_SPLAT_OPACITY "splat_opacity"

/* Of less than this a splat is haze. Those of surfaces are told from it by the same bar in Guedon
 * and Lepetit, SuGaR, CVPR 2024, section 4.1. */
#define SCAN_HAZE_BELOW 0.5

/* Normals of either side: axis_x axis_y axis_z. 0, 0, 0 is none. */
extern const char *const scan_axis_names[3];

/* Is point i of that column, or of NULL, haze? */
bool scan_is_haze(const scan_column *splat_opacity, size_t i);

#endif
