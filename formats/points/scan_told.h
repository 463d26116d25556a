/*
 * scan_told.h - what only the values of a whole scan tell about its columns, found once for those
 * that come part by part: what colours and opacities count to, and whether black means none.
 */
#ifndef SCAN_TOLD_H
#define SCAN_TOLD_H

#include "points/scan_color.h"
#include "points/scan_opacity.h"

typedef struct scan_told {
	scan_color albedo, color; /* without columns; a range of 0: there are none of this kind */
	bool blank;               /* black points of `color` have no colour */
	scan_opacity_told opacity;
} scan_told;

/* Finds it by a cloud, of all points or of so many that are spread over it. GW_ERROR_DATA where
 * opacities are not what they may be. */
gw_status scan_told_find(const scan *cloud, scan_told *told, gw_error *error);

/* As scan_color_find of albedo_r and its fellows (own) or of red and its fellows, but by what was
 * told, unless that is NULL. */
bool scan_told_color(const scan_told *told, const scan *cloud, bool own, scan_color *color);

#endif
