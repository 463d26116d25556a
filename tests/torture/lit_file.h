/*
 * lit_file.h - reads what a bake wrote, by nothing that glowworm has: PLY points and the report.
 */
#ifndef LIT_FILE_H
#define LIT_FILE_H

#include "torture_case.h"

typedef struct lit_file {
	size_t count;
	double *at;       /* 3 * count */
	double *radiance; /* 3 * count */
	double *value;    /* every number of the file, value_count = count * columns */
	size_t columns;
} lit_file;

/* False, after a failure of the case, when it is not a whole PLY file with radiance. */
bool lit_file_read(torture_case *c, const char *row, const char *name, lit_file *lit);
void lit_file_clear(lit_file *lit);

/* Mean of the green radiance over points [first, end). */
double lit_file_mean(const lit_file *lit, size_t first, size_t end);

#define REPORT_BOUNCES 4096

/* What a report says; NaN where it says nothing. */
typedef struct lit_report {
	double energy[REPORT_BOUNCES];   /* sent out after each bounce */
	double carriers[REPORT_BOUNCES]; /* how many records brought it */
	double largest[REPORT_BOUNCES];  /* irradiance of any of them */
	size_t bounces;
	double records, error, spread, remaining, depth, leaf_size, spacing, left_out;
} lit_report;

bool lit_report_read(torture_case *c, const char *row, const char *name, lit_report *report);

#endif
