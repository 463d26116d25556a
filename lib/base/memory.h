/*
 * memory.h - host memory for arrays whose size comes from data.
 *
 * All of lib/ takes its arrays from here, so that no product of count and size can overflow.
 * Thread-safe.
 */
#ifndef MEMORY_H
#define MEMORY_H

#include "glowworm_host.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * An array of `count` elements of `size` bytes, not initialised, for free(). A count of 0 gives a
 * valid pointer, so that NULL always means failure: the product overflows or memory is short.
 */
void *gw_allocate_array(size_t count, size_t size);

/* The same, filled with zeros. */
void *gw_allocate_zeros(size_t count, size_t size);

/*
 * Resizes an array from one of the functions above (or NULL) to `count` elements and keeps its
 * content. On failure returns NULL, and the array is still the caller's.
 */
void *gw_resize_array(void *array, size_t count, size_t size);

/* Frees an array, unless it lies in the bytes from `lent` on, which are somebody else's. */
void gw_free_unless_lent(void *array, const void *lent, size_t bytes);

/* Gives the system what was freed, where the C library keeps it to give it out again: for those who
 * go on with much less than they had. */
void gw_give_back_memory(void);

/*
 * Advises the system to hold large memory in huge pages: a bake of a million points takes a fifth
 * less processor time when its arrays are not in pages of 4 KiB. The functions above do it by
 * themselves. Advice only: nothing changes where the system does not go by it.
 */
void gw_wish_huge_pages(void *memory, size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
