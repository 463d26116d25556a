/*
 * sort_layout.h - push-constant blocks of the prefix sum and the radix sort, shared by C and GLSL.
 *
 * Every block starts with the span that the device layer fills (gpu.h).
 */
#ifndef SORT_LAYOUT_H
#define SORT_LAYOUT_H

#include "base/shared_types.h"

/* Elements that one invocation of the prefix sum adds up. */
#define GW_PREFIX_RUN 128u

/* Values of one digit of the radix sort, and keys of one invocation, at most. */
#define GW_RADIX_DIGITS 256u
#define GW_RADIX_RUN_MAX 4096u

SHARED_STRUCT(gw_prefix_push)
{
	uint first, count;
	uint source;  /* first word of what is added up */
	uint sums;    /* first word of the sums of runs */
	uint total;   /* words of the source */
	uint scan;    /* 0: add up runs; 1: turn the source into prefix sums */
	uint offsets; /* scan: the runs' sums hold what comes before them; else nothing does */
};
SHARED_SIZE(gw_prefix_push, 28);

SHARED_STRUCT(gw_radix_push)
{
	uint first, count;
	uint total; /* elements */
	uint run;   /* elements an invocation */
	uint runs;
	uint shift; /* of the digit, in its word */
	uint index; /* 1: an element's payload is its index */
	uint wide;  /* keys have a high word */
	uint high;  /* and the digit is in it */
};
SHARED_SIZE(gw_radix_push, 36);

#endif
