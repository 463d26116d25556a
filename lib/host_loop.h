/*
 * host_loop.h - what loops of the host that stand in for passes have in common.
 */
#ifndef HOST_LOOP_H
#define HOST_LOOP_H

#include "clock.h"
#include "parallel.h"
#include "passes.h"

/* Runs the loop over `count` elements, and books its time as that of the pass. The pieces, of
 * `chunk` elements each, don't depend on the number of threads. */
static inline void gw_host_loop(gw_passes *passes, gw_pass_id id, size_t count, size_t chunk,
								gw_parallel_work *work, void *job)
{
	double start = gw_seconds();
	gw_parallel_for(passes->threads, count, chunk, work, job);
	passes->device_seconds[id] += gw_seconds() - start;
}

#endif
