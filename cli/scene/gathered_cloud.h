/*
 * gathered_cloud.h - inputs that memory does not hold and that cannot be read in parts as they are,
 * because they are several or of a format that has no parts: copied, piece after piece, into one
 * that can.
 */
#ifndef GATHERED_CLOUD_H
#define GATHERED_CLOUD_H

#include "options/settings.h"
#include "table/format_parts.h"

/* What one input was. */
typedef struct gathered_input {
	const format *format;
	uint64_t points, left_out;
} gathered_input;

typedef struct gathered_cloud_use {
	const char *output; /* the copy is made beside it; NULL, or no file: among others' that last a
						   while */
	uint64_t memory;    /* bytes that all may take */
	uint64_t fit;       /* so many points need not be gathered, */
	bool always;        /* unless this is set */
	bool quiet;         /* nothing is said of it */
} gathered_cloud_use;

/*
 * Gathers all inputs, if they are clouds in files, with nothing said of one that is not of all, and
 * so many that memory does not hold them while they are read. Else nothing is found in *parts.
 *   parts   to be given back with format_parts_close
 *   input   receives what each of them was, for free(), where they were gathered; else NULL
 * Fails like format_pieces_next and gathered_points_add; GW_ERROR_USAGE where inputs have different
 * axes up, or coordinates that do not agree; GW_ERROR_CANCELLED.
 */
gw_status gathered_cloud_make(const settings *settings, const gathered_cloud_use *use,
							  format_parts *parts, gathered_input **input, gw_error *error);

#endif
