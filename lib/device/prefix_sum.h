/*
 * prefix_sum.h - exclusive prefix sums of 32-bit words on the device.
 *
 * Belongs to the thread of its gw_gpu.
 */
#ifndef PREFIX_SUM_H
#define PREFIX_SUM_H

#include "device/passes.h"

/* All zero is one that has not run yet. */
typedef struct gw_prefix_sum {
	gw_buffer sums; /* of runs, and of runs of these; grows as needed */
} gw_prefix_sum;

void gw_prefix_sum_destroy(gw_gpu *gpu, gw_prefix_sum *prefix); /* a zeroed one is accepted */

/*
 * Replaces each word by the sum of those before it.
 *   words   a buffer of at least `count` words that can be bound as a whole; a run of 128 of them
 *           must add up to less than 2^32
 *   count   0 is fine
 *   total   NULL, or receives the sum of all words. It may be 2^32 or more; then the prefix sums
 *           have wrapped around and the caller must not use them
 * Fails as gw_buffer_create and gw_passes_run.
 */
gw_status gw_prefix_sum_run(gw_passes *passes, gw_prefix_sum *prefix, gw_buffer *words,
							uint64_t count, uint64_t *total, gw_error *error);

#endif
