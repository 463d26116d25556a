/*
 * counted_memory.h - malloc and its kin, counted, and failing on demand.
 *
 * The linker leads a test's calls here (--wrap, see the Makefile). Not for several threads at once.
 */
#ifndef COUNTED_MEMORY_H
#define COUNTED_MEMORY_H

#include "glowworm.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct counted_memory {
	size_t live, peak, largest; /* bytes since the last reset; largest: asked for in one call */
	long calls;                 /* since the last reset */
	long fail_at;               /* which call shall fail; -1: none */
} counted_memory;

extern counted_memory counted;

/* Counts from zero; fail_at stays. */
void counted_memory_reset(void);

/* Calls something again and again, with the first allocation failing, then the second, until it
 * ends with GW_OK; every time before that it must end with GW_ERROR_MEMORY, which is asserted.
 * Returns how often it failed. */
long counted_memory_exhaust(gw_status (*call)(void *user, long failing), void *user);

/* Memory that does not count. */
void *uncounted_malloc(size_t size);
void uncounted_free(void *memory);

#endif
