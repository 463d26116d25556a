/*
 * parted_copy.h - one file's points, read part by part, changed by the caller, and written in their
 * order as another file, so that memory never holds all of them.
 */
#ifndef PARTED_COPY_H
#define PARTED_COPY_H

#include "files/output_file.h"
#include "options/output_shift.h"
#include "options/settings.h"
#include "table/format_parts.h"

/* About as many points are in a part: a fine grain of progress, and next to no memory. */
#define PARTED_COPY_POINTS ((size_t)1 << 18)

typedef struct parted_copy {
	const settings *settings; /* of a run with one input and s->output, or `path` */
	const char *path;         /* of the output */
	const format *format;     /* its */
	output_file *output;
	output_shift *shift;
	format_parts parts;
	size_t step; /* points of a part */
	scan told;   /* after parted_copy_settle: one point, and what the file says of all of them */
	format_whole whole;
	bool begun; /* the output has its head */
} parted_copy;

/*
 * Looks whether the input can be read in parts, more than once, and the output be written so. What
 * is packed takes its time each time: it is read at once wherever memory holds it, with what is
 * made of it; and so is what has no parts, or else it is gathered first (gathered_cloud.h).
 *   copy     with all before `parts` set but the output; to be given back with parted_copy_close,
 *            also on failure
 *   options  how the input is read
 *   parted   receives whether it is: otherwise all is to be read at once
 */
gw_status parted_copy_open(parted_copy *copy, const format_options *options, bool *parted,
						   gw_error *error);

/*
 * Learns what has to be known of all points before the first is written, by reading them as often
 * as that takes: columns, the box for a shift, what the output's format asks for.
 *   parted   receives false where only all points at once tell all; then that is to be done, and
 *            nothing was written
 */
gw_status parted_copy_settle(parted_copy *copy, bool *parted, gw_error *error);

/* Chooses the shift by all points, after that, as output_shift_settle does. */
void parted_copy_settle_shift(parted_copy *copy);

/* Then checks --las-step, as output_system_check_step does. */
gw_status parted_copy_check_step(const parted_copy *copy, gw_error *error);

/* The points from number `first` on, a part of them; to be freed with scan_clear. */
gw_status parted_copy_read(parted_copy *copy, uint64_t first, scan *part, gw_error *error);

/* Writes a part, as it is to be there, behind those before; and before the first what goes before
 * it, for all of which there has to be room. */
gw_status parted_copy_write(parted_copy *copy, const scan *part, gw_error *error);

/* What goes behind the last. */
gw_status parted_copy_end(parted_copy *copy, gw_error *error);

void parted_copy_close(parted_copy *copy);

#endif
