/*
 * output_shift.h - --shift: coordinates that are written as floats about a place of their own.
 */
#ifndef OUTPUT_SHIFT_H
#define OUTPUT_SHIFT_H

#include "points/scan.h"

struct format; /* format.h */

typedef struct output_shift {
	bool wanted;    /* there is one, or may be */
	bool automatic; /* it is still to be chosen */
	double by[3];   /* taken off the coordinates */
} output_shift;

/*
 * Reads "auto" or X,Y,Z.
 *   text    NULL: none is wanted
 *   to      the format that is written; NULL: no points are
 *   error   GW_ERROR_USAGE: it is neither, or the format has no place that says it
 */
gw_status output_shift_read(const char *text, const struct format *to, output_shift *shift,
							gw_error *error);

/* Chooses one for coordinates within a box, if it is automatic, and says what becomes of them on
 * standard error unless it is to be quiet. */
void output_shift_settle(output_shift *shift, const double low[3], const double high[3],
						 bool quiet);

/* The same by the coordinates of a scan. */
void output_shift_settle_by(output_shift *shift, const scan *cloud, bool quiet);

/* Shifts the coordinates of a scan that is to be written, if that is wanted. Fails as
 * scan_shift_apply. */
gw_status output_shift_apply(const output_shift *shift, scan *cloud, gw_error *error);

#endif
