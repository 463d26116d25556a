/*
 * cpu_loop.h - loops of the processor that stand in for passes.
 */
#ifndef CPU_LOOP_H
#define CPU_LOOP_H

#include "glowworm_host.h"
#include "device/gpu_internal.h"
#include "device/kernel.h"
#include "base/parallel.h"
#include "device/passes.h"

#include <stdatomic.h>
#include <string.h>

/* Asks, in the caller's own thread, whether to stop; whether anybody was told so. */
static inline bool gw_loop_stopped(gw_gpu *gpu, uint32_t worker, atomic_bool *stopped)
{
	if (worker == 0 && gw_gpu_stopped(gpu))
		atomic_store(stopped, true);
	return atomic_load_explicit(stopped, memory_order_relaxed);
}

typedef struct gw_stoppable_loop {
	gw_gpu *gpu;
	gw_parallel_work *work;
	void *job;
	atomic_bool stopped;
} gw_stoppable_loop;

static inline void gw_work_unless_stopped(void *user, size_t first, size_t last, uint32_t worker)
{
	gw_stoppable_loop *loop = user;
	if (!gw_loop_stopped(loop->gpu, worker, &loop->stopped))
		loop->work(loop->job, first, last, worker);
}

/* Runs the loop over `count` elements, and books its time as that of the pass. The pieces, of
 * `chunk` elements each, don't depend on the number of threads. The caller's thread asks between
 * them whether to stop: then results are missing, and the next call of the device says so. */
static inline void gw_cpu_loop(gw_passes *passes, gw_pass_id id, size_t count, size_t chunk,
							   gw_parallel_work *work, void *job)
{
	double start = gw_seconds();
	gw_stoppable_loop loop = { .gpu = passes->gpu, .work = work, .job = job };
	/* After a stop this loop's own input is missing, too. */
	if (!gw_gpu_stopped(passes->gpu))
		gw_parallel_for(passes->threads, count, chunk, gw_work_unless_stopped, &loop);
	passes->device_seconds[id] += gw_seconds() - start;
}

/* One run of a kernel. */
typedef struct gw_kernel_run {
	gw_kernel *kernel;
	const gw_binding *bindings;
	const void *push;        /* as gw_passes_run has it */
	const uint32_t *element; /* which elements are run, or NULL: all */
	gw_kernel_input input;   /* what gw_kernel_loop makes of it */
} gw_kernel_run;

static inline void gw_kernel_work(void *user, size_t first, size_t last, uint32_t worker)
{
	const gw_kernel_run *run = user;
	(void)worker;
	run->kernel(&run->input, first, last);
}

/* Runs a kernel by gw_cpu_loop. */
static inline void gw_kernel_loop(gw_passes *passes, gw_pass_id id, gw_kernel_run run,
								  uint64_t count, size_t chunk)
{
	_Alignas(16) unsigned char push[GW_PUSH_BYTES_MAX] = { 0 };
	const gw_span all = { .first = 0, .count = UINT32_MAX };
	memcpy(push, run.push, gw_pass_row_of(id)->push_bytes);
	memcpy(push, &all, sizeof all);
	run.input = (gw_kernel_input){ run.bindings, passes->constant, push, run.element };
	gw_cpu_loop(passes, id, (size_t)count, chunk, gw_kernel_work, &run);
}

#endif
