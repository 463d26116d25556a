/*
 * parallel.h - threads; loops over them are in glowworm_host.h.
 */
#ifndef PARALLEL_H
#define PARALLEL_H

#include "glowworm_host.h"

#include <signal.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The most threads that gw_parallel_for starts. */
#define GW_THREADS_MAX 256u

/* What threads block that are not the program's own, so that its handlers run there: all signals
 * but those of a thread's own faults, which would end the process unheard. */
void gw_signals_to_block(sigset_t *set);

/* How many of so many threads, at most GW_THREADS_MAX, can be started at the same time. For those
 * who start threads without looking whether they run. */
uint32_t gw_threads_startable(uint32_t wanted);

/* Does any other thread of this process run, or wait for a disk? False where the system does not
 * say. */
bool gw_threads_any_busy(void);

#ifdef __cplusplus
}
#endif

#endif
