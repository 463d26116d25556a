/*
 * luminaire_files.h - IES and EULUMDAT files of lamps whose intensity is a function.
 */
#ifndef LUMINAIRE_FILES_H
#define LUMINAIRE_FILES_H

#include <stddef.h>

/* Room for the largest of these files. */
#define LUMINAIRE_FILE 4000000

/* Intensity in a direction, unit: x toward C 0, y toward C 90, z along the axis. */
typedef double (*luminaire_shape)(double x, double y, double z);

/* Angles of a file, degrees. */
typedef struct luminaire_grid {
	double vertical[3], horizontal[3]; /* first, last, step; of step 0: the first alone */
} luminaire_grid;

/* Writes an IES file of type 'C', 'B' or 'A' of 1 m by 2 m and 10 W. Returns its length. */
size_t luminaire_file_ies(char *text, char type, const luminaire_grid *grid, luminaire_shape shape);

/* Writes an EULUMDAT file of that symmetry, 0 to 4, of a lamp of 2000 lm: planes 15 degrees apart,
 * angles in them 2.5. Returns its length. */
size_t luminaire_file_eulumdat(char *text, int symmetry, luminaire_shape shape);

#endif
