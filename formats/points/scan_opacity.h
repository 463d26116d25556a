/*
 * scan_opacity.h - the opacity of points, from columns.
 */
#ifndef SCAN_OPACITY_H
#define SCAN_OPACITY_H

#include "points/scan.h"

/* The column that says how opaque points are, `opacity` or else `alpha`; NULL: all are. */
const scan_column *scan_opacity_find(const scan *cloud);

/* What only all values tell. */
typedef struct scan_opacity_told {
	double full; /* what they count up to */
	bool opaque; /* all points are */
} scan_opacity_told;

/* What the column's values count up to. */
double scan_opacity_full(const scan_column *column, size_t count);

/*
 * Opacities from 0 to 1. Bytes count up to 255 and other integers to 65535; floats up to 1 or,
 * where one is larger and all are whole numbers, to 255. Where all of `alpha` is 0 nobody has
 * filled it, and all points are opaque.
 *   told      NULL; or what the whole tells of which the scan is a part
 *   opacity   count of the scan, for free(); NULL where all points are opaque
 * Fails with GW_ERROR_DATA where a value is no opacity.
 */
gw_status scan_opacity_make(const scan *cloud, const scan_opacity_told *told, float **opacity,
							gw_error *error);

#endif
