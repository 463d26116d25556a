/*
 * prefix_sum.c - see prefix_sum.h. Runs of words are added up, and runs of these sums, until one is
 * left; then, from the last to the first, runs become prefix sums. The sums of all levels lie in
 * one buffer one after the other.
 */
#include "device/prefix_sum.h"

#include "base/memory.h"
#include "device/named_pass.h"
#include "device/sort_layout.h"

#include <stdlib.h>
#include <string.h>

/* 128^5 > 2^32 */
#define LEVELS_MAX 6

typedef struct level {
	uint32_t first, count;
} level;

gw_status gw_prefix_sum_create(gw_gpu *gpu, gw_prefix_sum *prefix, gw_error *error)
{
	memset(prefix, 0, sizeof *prefix);
	if (gw_gpu_is_host(gpu))
		return GW_OK;
	return gw_named_pass_create(gpu, "prefix_sum", "SS", sizeof(gw_prefix_push), GW_PREFIX_RUN,
								&prefix->pass, error);
}

void gw_prefix_sum_destroy(gw_gpu *gpu, gw_prefix_sum *prefix)
{
	gw_buffer_destroy(gpu, &prefix->sums);
	gw_pass_destroy(gpu, &prefix->pass);
}

static gw_status run_level(gw_gpu *gpu, gw_prefix_sum *prefix, gw_buffer *words,
						   const level *levels, uint32_t i, bool scan, bool offsets,
						   gw_error *error)
{
	gw_prefix_push push = {
		.source = i == 0 ? 0 : levels[i].first,
		.sums = levels[i + 1].first,
		.total = levels[i].count,
		.scan = scan,
		.offsets = offsets,
	};
	gw_binding bindings[] = { { .buffer = i == 0 ? words : &prefix->sums },
							  { .buffer = &prefix->sums } };
	return gw_pass_run(gpu, prefix->pass, bindings, &push, levels[i + 1].count, error);
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

/* The same on a device that is the host's own processor. */
static void run_on_host(uint32_t *word, uint64_t count, uint64_t *total)
{
	uint64_t sum = 0;
	for (uint64_t i = 0; i < count; i++) {
		uint32_t value = word[i];
		word[i] = (uint32_t)sum;
		sum += value;
	}
	if (total != NULL)
		*total = sum;
}

gw_status gw_prefix_sum_run(gw_gpu *gpu, gw_prefix_sum *prefix, gw_buffer *words, uint64_t count,
							uint64_t *total, gw_error *error)
{
	if (total != NULL)
		*total = 0;
	if (count == 0)
		return GW_OK;
	if (count > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "\"%s\" has %llu words, of which at most 2^32 - 1 can be added up: bake "
					   "with fewer points or a coarser octree",
					   words->name, (unsigned long long)count);
	if (prefix->pass == NULL) {
		run_on_host(words->mapped, count, total);
		return GW_OK;
	}
	level levels[LEVELS_MAX];
	uint32_t needed, last = plan_levels(count, levels, &needed);
	if (prefix->sums.bytes < UINT64_C(4) * needed) {
		gw_buffer_destroy(gpu, &prefix->sums);
		GW_TRY(gw_buffer_create(gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, UINT64_C(4) * needed,
								"sums of runs", &prefix->sums, error));
	}
	for (uint32_t i = 0; i < last; i++)
		if (i + 1 < last || total != NULL)
			GW_TRY(run_level(gpu, prefix, words, levels, i, false, false, error));
	if (total != NULL)
		GW_TRY(add_up(gpu, prefix, levels[1], total, error));
	for (uint32_t i = last; i-- > 0;)
		GW_TRY(run_level(gpu, prefix, words, levels, i, true, i + 1 < last, error));
	return GW_OK;
}
