/*
 * parallel.h - loops over host threads.
 */
#ifndef PARALLEL_H
#define PARALLEL_H

#include <signal.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The most threads that gw_parallel_for starts. */
#define GW_THREADS_MAX 256u

/* The number of threads to use: `requested`, or when it is 0 the number of processors that this
 * process may run on; at least 1, at most GW_THREADS_MAX. Thread-safe. */
uint32_t gw_thread_count(uint32_t requested);

/*
 * Work on elements [first, last) of a loop.
 *   worker   0 <= worker < number of threads; one worker runs one chunk at a time, so it can index
 *            scratch memory. Which chunks a worker gets depends on the schedule: nothing that ends
 *            up in a result may depend on it.
 */
typedef void gw_parallel_work(void *user, size_t first, size_t last, uint32_t worker);

/*
 * Calls work for every chunk of [0, count), on up to `threads` threads, and waits for all of them.
 * Chunks begin at multiples of `chunk`, whatever the number of threads. The calling thread is
 * worker 0; when a thread cannot be started the others do its share.
 *   threads  0 means one a processor
 *   chunk    elements, at least 1
 * Thread-safe.
 */
void gw_parallel_for(uint32_t threads, size_t count, size_t chunk, gw_parallel_work *work,
					 void *user);

/* What threads block that are not the program's own, so that its handlers run there: all signals
 * but those of a thread's own faults, which would end the process unheard. */
void gw_signals_to_block(sigset_t *set);

/* How many of so many threads, at most GW_THREADS_MAX, can be started at the same time. For those
 * who start threads without looking whether they run. */
uint32_t gw_threads_startable(uint32_t wanted);

#ifdef __cplusplus
}
#endif

#endif
