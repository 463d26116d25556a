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

/*
 * Reads a file: its words and planes by a function that knows its format, then the distribution.
 *   l   on success the caller's; empty on failure
 */
typedef gw_status luminaire_planes_body(luminaire_lines *lines, luminaire_planes *planes,
										luminaire *l);
gw_status luminaire_planes_read(const input_file *in, luminaire_planes_body *read, luminaire *l,
								gw_error *error);

#endif
