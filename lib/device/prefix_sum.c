/*
 * prefix_sum.c - see prefix_sum.h. Runs of words are added up, and runs of these sums, until one is
 * left; then, from the last to the first, runs become prefix sums. The sums of all levels lie in
 * one buffer one after the other.
 */
#include "device/prefix_sum.h"

#include "base/memory.h"
#include "device/kernel.h"
#include "device/sort_layout.h"
#include "base/parallel.h"

#include <stdlib.h>

#define CPU_RUNS 512u /* that a thread adds up at a time */

/* 128^5 > 2^32 */
#define LEVELS_MAX 6

typedef struct level {
	uint32_t first, count;
} level;

void gw_prefix_sum_destroy(gw_gpu *gpu, gw_prefix_sum *prefix)
{
	gw_buffer_destroy(gpu, &prefix->sums);
}

static gw_prefix_push push_of(const level *levels, uint32_t i, bool scan, bool offsets)
{
	return (gw_prefix_push){
		.source = i == 0 ? 0 : levels[i].first,
		.sums = levels[i + 1].first,
		.total = levels[i].count,
		.scan = scan,
		.offsets = offsets,
	};
}

/* Runs one level, whose words lie in `source`, by its `runs` runs. */
static gw_status run_level(gw_passes *passes, gw_prefix_sum *prefix, gw_buffer *source,
						   const gw_prefix_push *push, uint32_t runs, gw_error *error)
{
	gw_binding bindings[] = { { .buffer = source }, { .buffer = &prefix->sums } };
	return gw_passes_run(passes, GW_PASS_PREFIX_SUM, bindings, push, runs, error);
}

/* Level 0 are the words; they are not in the buffer of sums. */
static uint32_t plan_levels(uint64_t count, level levels[LEVELS_MAX], uint32_t *words)
{
	uint32_t last = 0, place = 0;
	levels[0] = (level){ 0, (uint32_t)count };
	do {
		uint32_t below = levels[last].count;
		uint32_t runs = below / GW_PREFIX_RUN + (below % GW_PREFIX_RUN != 0);
		levels[++last] = (level){ place, runs };
		place += runs;
	} while (levels[last].count > 1);
	*words = place;
	return last;
}

static gw_status add_up(gw_gpu *gpu, gw_prefix_sum *prefix, level runs, uint64_t *total,
						gw_error *error)
{
	uint32_t *sum = gw_allocate_array(runs.count, sizeof *sum);
	if (sum == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "not enough memory for %u sums", runs.count);
	gw_status status = gw_buffer_download(gpu, &prefix->sums, UINT64_C(4) * runs.first, sum,
										  UINT64_C(4) * runs.count, error);
	for (uint32_t i = 0; i < runs.count && status == GW_OK; i++)
		*total += sum[i];
	free(sum);
	return status;
}

gw_status gw_prefix_sum_run(gw_passes *passes, gw_prefix_sum *prefix, gw_buffer *words,
							uint64_t count, uint64_t *total, gw_error *error)
{
	gw_gpu *gpu = passes->gpu;
	if (total != NULL)
		*total = 0;
	if (count == 0)
		return GW_OK;
	if (count > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "\"%s\" has %llu words, of which at most 2^32 - 1 can be added up: bake "
					   "with fewer points or a coarser octree",
					   words->name, (unsigned long long)count);
	level levels[LEVELS_MAX];
	uint32_t needed, last = plan_levels(count, levels, &needed);
	if (prefix->sums.bytes < UINT64_C(4) * needed) {
		gw_buffer_destroy(gpu, &prefix->sums);
		GW_TRY(gw_buffer_create(gpu,
								&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
														  UINT64_C(4) * needed, "sums of runs" },
								&prefix->sums, error));
	}
	for (uint32_t i = 0; i < last; i++) {
		const gw_prefix_push push = push_of(levels, i, false, false);
		if (i + 1 < last || total != NULL)
			GW_TRY(run_level(passes, prefix, i == 0 ? words : &prefix->sums, &push,
							 levels[i + 1].count, error));
	}
	if (total != NULL)
		GW_TRY(add_up(gpu, prefix, levels[1], total, error));
	for (uint32_t i = last; i-- > 0;) {
		const gw_prefix_push push = push_of(levels, i, true, i + 1 < last);
		GW_TRY(run_level(passes, prefix, i == 0 ? words : &prefix->sums, &push, levels[i + 1].count,
						 error));
	}
	return GW_OK;
}

/* -------------------------------------------------------------------------------- CPU kernel */

static void add_up_runs(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	gw_kernel_prefix_sum(user, first, last);
}

void gw_cpu_prefix_sum(gw_passes *passes, const gw_binding *bindings, const void *push,
					   uint64_t count)
{
	gw_prefix_push all = *(const gw_prefix_push *)push;
	gw_kernel_input input = { .bindings = bindings, .constant = passes->constant, .push = &all };
	all.first = 0;
	all.count = UINT32_MAX;
	gw_parallel_for(passes->threads, (size_t)count, CPU_RUNS, add_up_runs, &input);
}
