/*
 * glowworm_host.h - public interface of libglowworm to the machine that it runs on, and to those
 * who read what it says: what programs around it would have to write again. Everything here is
 * thread-safe.
 */
#ifndef GLOWWORM_HOST_H
#define GLOWWORM_HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/* Seconds of a clock that never steps back; only differences mean something. */
double gw_seconds(void);

/*
 * Bytes of host memory that can be taken now without swapping: what the system reports as
 * available, and not more than the control group of this process and the limit of its addresses
 * leave. 0 when unknown.
 */
uint64_t gw_available_memory(void);

/* Bytes of memory that this process holds now; 0 where the system does not say. */
uint64_t gw_resident_memory(void);

/* The number of threads to use: `requested`, or when it is 0 the number of processors that this
 * process may run on; at least 1, at most 256. */
uint32_t gw_thread_count(uint32_t requested);

/*
 * Whether memory that was lent to the library, as that of gw_transport, has to stay as it is until
 * the process ends. So it is once a bake failed because its driver hangs, which may still read what
 * it was given; true from then on.
 */
bool gw_lent_memory_is_kept(void);

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
 */
void gw_parallel_for(uint32_t threads, size_t count, size_t chunk, gw_parallel_work *work,
					 void *user);

/* Which of two words or endings fits a number, as in gw_plural(n, "is", "are"): `one` for 1, else
 * `many`; one of the two pointers is returned. */
const char *gw_plural(uint64_t number, const char *one, const char *many);

/*
 * A number as people write it, for messages: 5.3 million and not 5.3e+06, 12350 and not 1.235e+04.
 * Whole thousands of a million and more are said in words, up to 1000 trillion; below a millionth
 * there are exponents.
 *   digits   1 to 15: to so many it is rounded
 *   text     receives it; returned
 */
#define GW_SAID_NUMBER 40
const char *gw_say_number(double value, int digits, char text[GW_SAID_NUMBER]);
#define GW_SAID(value, digits) gw_say_number(value, digits, (char[GW_SAID_NUMBER]){ 0 })

/* The same for a coordinate: six digits, or as many as it takes to a thousandth, and no words. */
const char *gw_say_place(double value, char text[GW_SAID_NUMBER]);
#define GW_SAID_PLACE(value) gw_say_place(value, (char[GW_SAID_NUMBER]){ 0 })

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
