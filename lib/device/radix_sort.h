/*
 * radix_sort.h - stable sort of keys of up to 64 bits, each with a 32-bit payload, on the device.
 *
 * Least significant digit first; the order of equal keys is kept, so that the result depends on
 * nothing but the input. Belongs to the thread of its gw_gpu.
 */
#ifndef RADIX_SORT_H
#define RADIX_SORT_H

#include "device/prefix_sum.h"

/* All zero is one that has not run yet. */
typedef struct gw_radix_sort {
	gw_prefix_sum prefix;
	gw_buffer counts; /* of digits in runs; grows as needed */
} gw_radix_sort;

/* Keys and payloads, each twice: what is sorted, and room for a copy. R32_UINT texel buffers. */
typedef struct gw_sort_list {
	gw_buffer low, high, payload; /* bits 0-31, bits 32-63 (none when not wide) */
	gw_buffer low_copy, high_copy, payload_copy;
	uint64_t count;
	bool wide;
} gw_sort_list;

void gw_radix_sort_destroy(gw_gpu *gpu, gw_radix_sort *sort); /* a zeroed one is accepted */

/* Allocates a list whose keys are to be written next: they are not set, and sorting sets the rest.
 * Fails as gw_buffer_create; zeroed then. */
gw_status gw_sort_list_create(gw_gpu *gpu, uint64_t count, bool wide, gw_sort_list *list,
							  gw_error *error);
void gw_sort_list_destroy(gw_gpu *gpu, gw_sort_list *list);
/* Frees the copies, which only sorting needs. */
void gw_sort_list_trim(gw_gpu *gpu, gw_sort_list *list);

/*
 * Sorts by the lowest `bits` bits of the keys.
 *   list   payloads come out as the index that each key had; what they were is ignored
 *   bits   1..64; at most 32 unless the list is wide
 * Fails as gw_passes_run, also when a buffer is too large to be bound as a whole.
 */
gw_status gw_radix_sort_run(gw_passes *passes, gw_radix_sort *sort, gw_sort_list *list,
							uint32_t bits, gw_error *error);

#endif
