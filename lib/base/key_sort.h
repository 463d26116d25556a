/* key_sort.h - sorting what has keys of 64 bits, on several threads. */
#ifndef KEY_SORT_H
#define KEY_SORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gw_keyed {
	uint64_t key;
	uint32_t item; /* whose key it is */
} gw_keyed;

/* Bytes that sorting takes for each element, beside the array; and 8 KiB a thread. */
#define GW_KEY_SORT_BYTES sizeof(gw_keyed)

/*
 * Sorts by key. What has the same key stays in its order, so that the number of threads changes
 * nothing.
 *   sorted   in: an array from gw_allocate_array of `count`, 0..2^30; receives it, or another
 *            such array in its place; the caller's in any case
 *   bits     of the keys, from the least significant one; 1..64. Digits that all keys have in
 *            common cost one look.
 *   threads  0 means one a processor
 * Returns false, with the array as it was, when memory is short.
 */
bool gw_sort_keyed(gw_keyed **sorted, size_t count, unsigned bits, uint32_t threads);

#endif
