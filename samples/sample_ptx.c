/* sample_ptx.c - see sample_scans.h */
#include "sample_points.h"
#include "sample_scans.h"

#include <stdio.h>
#include <stdlib.h>

void sample_scans_clear(sample_scan *scan, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		free(scan[i].cell);
		scan[i].cell = NULL;
	}
}

/* Size of the grid, the scanner's place and axes, and the same as a matrix for row vectors. */
static void print_header(FILE *file, const sample_scan *s)
{
	const double *r = s->rotation, *t = s->translation;

	fprintf(file, "%zu\n%zu\n%.6f %.6f %.6f\n", s->columns, s->rows, t[0], t[1], t[2]);
	for (int k = 0; k < 3; k++)
		fprintf(file, "%.12f %.12f %.12f\n", r[k], r[3 + k], r[6 + k]);
	for (int k = 0; k < 3; k++)
		fprintf(file, "%.12f %.12f %.12f 0\n", r[k], r[3 + k], r[6 + k]);
	fprintf(file, "%.6f %.6f %.6f 1\n", t[0], t[1], t[2]);
}

static void print_cell(FILE *file, const sample_cell *c)
{
	if (c->hole)
		fputs("0 0 0 0.500000 0 0 0\n", file);
	else
		fprintf(file, "%.6f %.6f %.6f %.6f %d %d %d\n", c->position[0], c->position[1],
				c->position[2], (double)c->intensity, c->color[0], c->color[1], c->color[2]);
}

int sample_write_ptx(const sample_scan *scan, size_t count, const char *path)
{
	FILE *file;
	int status = sample_open(path, true, &file);

	if (status)
		return status;
	for (size_t i = 0; i < count; i++) {
		print_header(file, &scan[i]);
		for (size_t c = 0; c < scan[i].columns * scan[i].rows && !ferror(file); c++)
			print_cell(file, &scan[i].cell[c]);
	}
	return sample_close(file, path);
}
