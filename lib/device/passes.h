/*
 * passes.h - running the passes of pass_table.h. Each is made when first run, so that a bake pays
 * only for those that its scene calls for; and each run goes one of two ways, as gw_passes_way says
 * and nothing else: by its shader on the device, or by its CPU kernel.
 */
#ifndef PASSES_H
#define PASSES_H

#include "device/pass_table.h"

/* All zero but for gpu and constants is a set of which nothing is made yet. */
struct gw_passes {
	gw_gpu *gpu;
	uint32_t constant[GW_PASS_CONSTANTS]; /* specialisation constants 1, 2, ... of all shaders that
											 have them; see octree_bindings.h */
	gw_pass *pass[GW_PASS_COUNT];
	double device_seconds[GW_PASS_COUNT]; /* as gw_passes_seconds last told, and what CPU kernels
											 took since */
	uint32_t threads;                     /* of CPU kernels; 0: one a processor */
};

/* What each took so far, by timestamps or, of a CPU kernel, by the clock: GW_PASS_COUNT numbers. It
 * waits for what is under way. */
const double *gw_passes_seconds(gw_passes *passes);

void gw_passes_destroy(gw_passes *passes); /* empty afterwards; an empty one is accepted */

typedef enum gw_pass_way {
	GW_WAY_DEVICE, /* the shader */
	GW_WAY_CPU,    /* the CPU kernel */
} gw_pass_way;

/*
 * The one place that decides. A CPU kernel runs if there is one, the buffers lie in the processor's
 * memory, and gw_gpu_options.passes leaves it the choice: there, with as many processors, it takes
 * a fraction of the shader's time.
 */
gw_pass_way gw_passes_way(const gw_passes *passes, gw_pass_id id);

/*
 * Runs a pass over count elements, see gw_pass_run.
 *   bindings  as the shader lists them
 *   push      of a pass with batches, it has all samples: the first, 0, and how many there are
 */
gw_status gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
						const void *push, uint64_t count, gw_error *error);

/* The same by the shader or by the CPU kernel, whatever gw_passes_way says, for tests. */
gw_status gw_passes_run_shader(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
							   const void *push, uint64_t count, gw_error *error);
void gw_passes_run_kernel(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
						  const void *push, uint64_t count);

/* How often a pass has run on a device, either way, and how often its shader was made ready. */
uint64_t gw_passes_runs(const gw_gpu *gpu, gw_pass_id id, uint32_t *compiled);

/* Bindings of whole buffers and of windows with `bytes` an element. */
static inline gw_binding gw_whole(const gw_buffer *buffer)
{
	return (gw_binding){ .buffer = (gw_buffer *)(uintptr_t)buffer };
}

static inline gw_binding gw_window(const gw_buffer *buffer, uint32_t bytes)
{
	return (gw_binding){ .buffer = (gw_buffer *)(uintptr_t)buffer, .stride = bytes };
}

static inline gw_binding gw_voxels_of(const gw_image *image)
{
	return (gw_binding){ .image = (gw_image *)(uintptr_t)image };
}

/* What one who has a device under way puts aside while somebody else uses it. */
typedef struct gw_gpu_aside {
	gw_gpu_account account;
	uint64_t budget;
	bool (*cancelled)(void *user);
	void *user;
	uint64_t pass_runs[GW_PASS_COUNT];
	uint32_t pass_compiled[GW_PASS_COUNT];
	bool keeps_passes;
} gw_gpu_aside;

/*
 * Lends an open device to somebody who begins with it again (gw_gpu_begin_again), and goes on after
 * that. Buffers and passes of before stay, count as taken, and are not to be used in between.
 * Afterwards the account has what either did; the runs of passes are those of before.
 */
void gw_gpu_put_aside(gw_gpu *gpu, gw_gpu_aside *aside);
void gw_gpu_go_on(gw_gpu *gpu, const gw_gpu_aside *aside);

#endif
