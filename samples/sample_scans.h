/*
 * sample_scans.h - scans as a laser scanner delivers them: a grid of cells for each station, in the
 * scanner's own frame, with the pose that takes it to the world; and writing them as PTX or E57.
 *
 * Like sample_points.h, these files use nothing of glowworm, so that they test its readers.
 */
#ifndef SAMPLE_SCANS_H
#define SAMPLE_SCANS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One direction of a scanner. */
typedef struct sample_cell {
	double position[3]; /* metres, in the scanner's frame */
	float intensity;    /* of the echo, 0..1 */
	uint8_t color[3];   /* sRGB */
	bool hole;          /* no echo: the rest means nothing */
} sample_cell;

typedef struct sample_scan {
	const char *name;
	double rotation[9];    /* rows; world = rotation * own + translation */
	double translation[3]; /* where the scanner stood, metres */
	size_t columns, rows;
	sample_cell *cell; /* owned; columns * rows, column after column, each from below */
} sample_scan;

/* Frees the cells of `count` scans. */
void sample_scans_clear(sample_scan *scan, size_t count);

/*
 * Write scans and return 0, or an exit code after a message on standard error. A file that could
 * not be written whole is removed.
 *   path     "-" is standard output
 *   comment  one line that says where they come from; PTX has no room for it
 * PTX: x y z with 6 decimals, intensity with 6, red green blue; holes are 0 0 0 0.5 0 0 0.
 * E57: cartesian coordinates in steps of SAMPLE_E57_STEP, intensity in 12 bits, colours, row and
 * column, and a state that is 2 for holes.
 */
int sample_write_ptx(const sample_scan *scan, size_t count, const char *path);
int sample_write_e57(const sample_scan *scan, size_t count, const char *path, const char *comment);

#define SAMPLE_E57_STEP 1e-5 /* metres */

#endif
