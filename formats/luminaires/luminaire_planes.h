/*
 * luminaire_planes.h - from the planes that a file has to all directions.
 */
#ifndef LUMINAIRE_PLANES_H
#define LUMINAIRE_PLANES_H

#include "luminaires/luminaire_lines.h"

/* Angles of one kind, and of luminaires, are no more than this. */
#define LUMINAIRE_ANGLES 8192

typedef struct luminaire_planes {
	double *vertical, *horizontal; /* owned; degrees */
	double *candela;               /* owned; for each horizontal angle all vertical ones */
	size_t verticals, horizontals;
	bool around; /* the planes go all around, even where the last is far from 360 degrees */
	char photometry;
} luminaire_planes;

void luminaire_planes_clear(luminaire_planes *planes);

/*
 * Fills the distribution of a luminaire. What symmetry leaves out is mirrored: planes of one angle
 * are the same all around; from 0 to 90, mirrored on both axes; 0 to 180 and 90 to 270, on one.
 * Types B and A are worked out on a grid of half a degree by two, and what begins at 0 degrees is
 * mirrored too.
 *   name   of the file, for messages
 * GW_ERROR_DATA when angles do not ascend, are out of range, or planes are missing; when an
 * intensity is negative, or all are 0. GW_ERROR_MEMORY.
 */
gw_status luminaire_from_planes(const char *name, const luminaire_planes *planes, luminaire *l,
								gw_error *error);

/*
 * Reads a file: its words and planes by a function that knows its format, then the distribution.
 *   l   on success the caller's; empty on failure
 */
typedef gw_status luminaire_planes_body(luminaire_lines *lines, luminaire_planes *planes,
										luminaire *l);
gw_status luminaire_planes_read(const input_file *in, luminaire_planes_body *read, luminaire *l,
								gw_error *error);

#endif
