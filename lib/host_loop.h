/*
 * host_loop.h - what loops of the host that stand in for passes have in common.
 */
#ifndef HOST_LOOP_H
#define HOST_LOOP_H

#include "clock.h"
#include "kernel.h"
#include "parallel.h"
#include "passes.h"

#include <stdatomic.h>

typedef struct gw_stoppable_loop {
	gw_gpu *gpu;
	gw_parallel_work *work;
	void *job;
	atomic_bool stopped;
} gw_stoppable_loop;

static inline void gw_work_unless_stopped(void *user, size_t first, size_t last, uint32_t worker)
{
	gw_stoppable_loop *loop = user;
	if (worker == 0 && gw_gpu_stopped(loop->gpu))
		atomic_store(&loop->stopped, true);
	if (!atomic_load_explicit(&loop->stopped, memory_order_relaxed))
		loop->work(loop->job, first, last, worker);
}

/* Runs the loop over `count` elements, and books its time as that of the pass. The pieces, of
 * `chunk` elements each, don't depend on the number of threads. The caller's thread asks between
 * them whether to stop: then results are missing, and the next call of the device says so. */
static inline void gw_host_loop(gw_passes *passes, gw_pass_id id, size_t count, size_t chunk,
								gw_parallel_work *work, void *job)
{
	double start = gw_seconds();
	gw_stoppable_loop loop = { .gpu = passes->gpu, .work = work, .job = job };
	/* After a stop this loop's own input is missing, too. */
	if (!gw_gpu_stopped(passes->gpu))
		gw_parallel_for(passes->threads, count, chunk, gw_work_unless_stopped, &loop);
	passes->device_seconds[id] += gw_seconds() - start;
}

/* One pass as a kernel: its bindings and its push constants. */
typedef struct gw_host_pass {
	gw_pass_id id;
	gw_kernel *kernel;
	const gw_binding *bindings;
	const void *push;
	const uint32_t *element; /* see gw_kernel_run */
} gw_host_pass;

typedef struct gw_host_job {
	gw_kernel *kernel;
	gw_kernel_run run;
} gw_host_job;

static inline void gw_host_work(void *user, size_t first, size_t last, uint32_t worker)
{
	const gw_host_job *job = user;
	(void)worker;
	job->kernel(&job->run, first, last);
}

/* Runs a pass over `count` elements by gw_host_loop. */
static inline void gw_host_run(gw_passes *passes, const gw_host_pass *pass, size_t count,
							   size_t chunk)
{
	gw_host_job job = { .kernel = pass->kernel,
						.run = { .bindings = pass->bindings,
								 .constant = passes->constant,
								 .push = pass->push,
								 .element = pass->element } };
	gw_host_loop(passes, pass->id, count, chunk, gw_host_work, &job);
}

#endif
