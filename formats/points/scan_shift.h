/*
 * scan_shift.h - coordinates as floats about a place of their own: those of a map, seven digits
 * before the point, are wider than floats resolve.
 *
 * The header of such a file has a comment of three numbers that are added to coordinates to make
 * them local, with the sign and under the name that CloudCompare has for them in its dialogs. It
 * shows the comment, and keeps it, but takes no notice; a reader of ours takes the numbers off
 * again.
 */
#ifndef SCAN_SHIFT_H
#define SCAN_SHIFT_H

#include "points/scan.h"

/* "Global Shift: -500000 -4000000 0" */
#define SCAN_SHIFT "Global Shift: "

/* From here on floats are a millimetre apart or more, and CloudCompare asks for a shift. */
#define SCAN_SHIFT_LEAST 10000.0
/* To how many metres one that is chosen is rounded. */
#define SCAN_SHIFT_STEP 1000.0

/* Widens a box by the finite coordinates of a scan; begins with low above high. */
void scan_shift_bounds(const scan *cloud, double low[3], double high[3]);

/*
 * Chooses what to take off the coordinates within a box: of each axis on which some are
 * SCAN_SHIFT_LEAST or more from 0 its middle, rounded to SCAN_SHIFT_STEP, and of others 0.
 * Returns whether there is such an axis.
 */
bool scan_shift_choose(const double low[3], const double high[3], double shift[3]);

/* Takes a shift off the coordinates, which become floats, and says so in a comment. GW_ERROR_DATA
 * where one of them is beyond floats then; GW_ERROR_MEMORY. */
gw_status scan_shift_apply(scan *cloud, const double shift[3], gw_error *error);

/*
 * Adds the shift that a comment says, which goes, to coordinates, which become doubles: if they are
 * floats, since whatever else writes doubles has added it. A note says so. GW_ERROR_MEMORY.
 */
gw_status scan_shift_undo(scan *cloud, gw_error *error);

#endif
