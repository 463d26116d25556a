/*
 * scan_rows.h - rows and columns of a scanner's or depth camera's picture, found again in clouds
 * whose file no longer tells of them.
 *
 * Written as a plain list, in the frame of who took it, such a picture still has its points in the
 * directions of its cells: of a camera x / z and y / z, of a scanner azimuth and elevation take as
 * many values as there are columns and rows, evenly spaced. Noise and steps of the ranges are along
 * the rays and change nothing of that.
 */
#ifndef SCAN_ROWS_H
#define SCAN_ROWS_H

#include "points/scan.h"

/*
 * Looks for them as seen from the scan's one scanner, or from the origin if it has none; a camera
 * along z either way or along x, a scanner that turns about z or y. Where they are found, adds the
 * image, the scanner, a note, and -y as up of a camera whose rows go down y in the order of the
 * file. A part that was cut out of a picture, as of one thing in it, is found like all of it.
 * Of a scanner whose columns are of uneven widths, as of a laser on a head that does not turn
 * evenly, the place is added alone, with a note. A scan with images or several scanners stays as it
 * is, and so do one whose points are no longer in the frame of who took them, and one whose
 * coordinates are rounded to more than about a hundredth of a cell.
 *
 *   moved   the points will be moved to where they belong, or stand among others: which way is up
 *           is then not for them to say
 *
 * GW_ERROR_MEMORY.
 */
gw_status scan_find_rows(scan *scan, bool moved, gw_error *error);

#endif
