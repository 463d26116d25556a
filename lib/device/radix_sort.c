/*
 * radix_sort.c - see radix_sort.h. One digit at a time: count digits in runs of keys, make the
 * counts places by a prefix sum, and put the keys there.
 */
#include "device/radix_sort.h"

#include "device/sort_layout.h"
#include "base/parallel.h"

#include <assert.h>
#include <string.h>

#define DIGIT_BITS 8u
_Static_assert(GW_RADIX_DIGITS == 1u << DIGIT_BITS, "a digit has that many values");

/* Keys an invocation: as few as leave work for a wide device, but the counts a small share. */
#define RUN_MIN 64u
#define RUNS_WANTED 4096u

#define CPU_RUNS 16u /* the same for CPU kernels, at most: two a thread of a usual machine */

void gw_radix_sort_destroy(gw_gpu *gpu, gw_radix_sort *sort)
{
	gw_buffer_destroy(gpu, &sort->counts);
	gw_prefix_sum_destroy(gpu, &sort->prefix);
}

gw_status gw_sort_list_create(gw_gpu *gpu, uint64_t count, bool wide, gw_sort_list *list,
							  gw_error *error)
{
	memset(list, 0, sizeof *list);
	list->count = count;
	list->wide = wide;
	const struct {
		gw_buffer *buffer;
		const char *name;
		bool needed;
	} part[] = {
		{ &list->low, "keys, low words", true },
		{ &list->payload, "order of keys", true },
		{ &list->low_copy, "keys, low words, copy", true },
		{ &list->payload_copy, "order of keys, copy", true },
		{ &list->high, "keys, high words", wide },
		{ &list->high_copy, "keys, high words, copy", wide },
	};
	for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
		if (!part[i].needed)
			continue;
		gw_status status =
			gw_buffer_create_unset(gpu,
								   &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
															 4 * count, part[i].name },
								   part[i].buffer, error);
		if (status != GW_OK) {
			gw_sort_list_destroy(gpu, list);
			return status;
		}
	}
	return GW_OK;
}

void gw_sort_list_trim(gw_gpu *gpu, gw_sort_list *list)
{
	gw_buffer_destroy(gpu, &list->low_copy);
	gw_buffer_destroy(gpu, &list->high_copy);
	gw_buffer_destroy(gpu, &list->payload_copy);
}

void gw_sort_list_destroy(gw_gpu *gpu, gw_sort_list *list)
{
	gw_sort_list_trim(gpu, list);
	gw_buffer_destroy(gpu, &list->low);
	gw_buffer_destroy(gpu, &list->high);
	gw_buffer_destroy(gpu, &list->payload);
}

static void swap(gw_buffer *a, gw_buffer *b)
{
	gw_buffer kept = *a;
	*a = *b;
	*b = kept;
}

static void swap_copies(gw_sort_list *list)
{
	swap(&list->low, &list->low_copy);
	swap(&list->high, &list->high_copy);
	swap(&list->payload, &list->payload_copy);
}

static gw_status sort_digit(gw_passes *passes, gw_radix_sort *sort, gw_sort_list *list,
							gw_radix_push push, gw_error *error)
{
	gw_buffer *word = push.high ? &list->high : &list->low;
	/* A narrow list has no high words; nothing touches what stands in. */
	gw_buffer *high = list->wide ? &list->high : &list->low;
	gw_buffer *high_copy = list->wide ? &list->high_copy : &list->low_copy;
	gw_binding counting[] = { { .buffer = word }, { .buffer = &sort->counts } };
	GW_TRY(gw_passes_run(passes, GW_PASS_RADIX_COUNT, counting, &push, push.runs, error));
	uint64_t counts = (uint64_t)push.runs * GW_RADIX_DIGITS;
	GW_TRY(gw_prefix_sum_run(passes, &sort->prefix, &sort->counts, counts, NULL, error));
	gw_binding scattering[] = { { .buffer = &list->low },         { .buffer = high },
								{ .buffer = &list->payload },     { .buffer = &sort->counts },
								{ .buffer = &list->low_copy },    { .buffer = high_copy },
								{ .buffer = &list->payload_copy } };
	GW_TRY(gw_passes_run(passes, GW_PASS_RADIX_SCATTER, scattering, &push, push.runs, error));
	swap_copies(list);
	return GW_OK;
}

static uint32_t keys_of_run(const gw_passes *passes, uint64_t count)
{
	if (gw_passes_way(passes, GW_PASS_RADIX_COUNT) == GW_WAY_CPU)
		return (uint32_t)(count / CPU_RUNS + 1);
	uint64_t run = count / RUNS_WANTED + 1;
	return run < RUN_MIN ? RUN_MIN : run > GW_RADIX_RUN_MAX ? GW_RADIX_RUN_MAX : (uint32_t)run;
}

gw_status gw_radix_sort_run(gw_passes *passes, gw_radix_sort *sort, gw_sort_list *list,
							uint32_t bits, gw_error *error)
{
	gw_gpu *gpu = passes->gpu;
	assert(bits >= 1 && bits <= (list->wide ? 64u : 32u));
	if (list->count == 0)
		return GW_OK;
	if (list->count > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%llu keys cannot be sorted at once: bake with fewer points or a coarser "
					   "octree",
					   (unsigned long long)list->count);
	uint32_t run = keys_of_run(passes, list->count);
	gw_radix_push push = {
		.total = (uint32_t)list->count,
		.run = run,
		.runs = (uint32_t)((list->count + run - 1) / run),
		.wide = list->wide,
	};
	uint64_t counts = UINT64_C(4) * push.runs * GW_RADIX_DIGITS;
	if (sort->counts.bytes < counts) {
		gw_buffer_destroy(gpu, &sort->counts);
		GW_TRY(
			gw_buffer_create_unset(gpu,
								   &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
															 counts, "counts of digits" },
								   &sort->counts, error));
	}
	for (uint32_t bit = 0; bit < bits; bit += DIGIT_BITS) {
		push.shift = bit % 32;
		push.high = bit >= 32;
		push.index = bit == 0;
		GW_TRY(sort_digit(passes, sort, list, push, error));
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- CPU kernels */

/* Digits of runs. Each run counts in an array of its own and has its counts, which lie apart, read
 * and written once: threads that share cache lines would wait for each other. */
typedef struct digit_job {
	const gw_radix_push *push;
	const uint32_t *word, *low, *high, *payload;
	uint32_t *low_out, *high_out, *payload_out, *counts;
} digit_job;

static uint32_t digit_of(const digit_job *job, size_t i)
{
	return job->word[i] >> job->push->shift & (GW_RADIX_DIGITS - 1);
}

static size_t end_of_run(const digit_job *job, size_t run)
{
	size_t end = (run + 1) * job->push->run;
	return end < job->push->total ? end : job->push->total;
}

static void count_runs(void *user, size_t first, size_t last, uint32_t worker)
{
	const digit_job *job = user;
	(void)worker;
	for (size_t run = first; run < last; run++) {
		uint32_t count[GW_RADIX_DIGITS] = { 0 };
		for (size_t i = run * job->push->run; i < end_of_run(job, run); i++)
			count[digit_of(job, i)]++;
		for (size_t digit = 0; digit < GW_RADIX_DIGITS; digit++)
			job->counts[digit * job->push->runs + run] = count[digit];
	}
}

void gw_cpu_radix_count(gw_passes *passes, const gw_binding *bindings, const void *push,
						uint64_t count)
{
	digit_job job = { .push = push,
					  .word = bindings[0].buffer->mapped,
					  .counts = bindings[1].buffer->mapped };
	gw_parallel_for(passes->threads, (size_t)count, 1, count_runs, &job);
}

static void scatter_run(const digit_job *job, size_t run, uint32_t place[GW_RADIX_DIGITS])
{
	bool wide = job->push->wide != 0, index = job->push->index != 0;
	for (size_t i = run * job->push->run; i < end_of_run(job, run); i++) {
		uint32_t to = place[digit_of(job, i)]++;
		job->low_out[to] = job->low[i];
		if (wide)
			job->high_out[to] = job->high[i];
		job->payload_out[to] = index ? (uint32_t)i : job->payload[i];
	}
}

static void scatter_runs(void *user, size_t first, size_t last, uint32_t worker)
{
	const digit_job *job = user;
	(void)worker;
	for (size_t run = first; run < last; run++) {
		uint32_t place[GW_RADIX_DIGITS];
		for (size_t digit = 0; digit < GW_RADIX_DIGITS; digit++)
			place[digit] = job->counts[digit * job->push->runs + run];
		scatter_run(job, run, place);
		for (size_t digit = 0; digit < GW_RADIX_DIGITS; digit++)
			job->counts[digit * job->push->runs + run] = place[digit];
	}
}

void gw_cpu_radix_scatter(gw_passes *passes, const gw_binding *bindings, const void *push,
						  uint64_t count)
{
	const gw_radix_push *p = push;
	digit_job job = { .push = push,
					  .word = bindings[p->high ? 1 : 0].buffer->mapped,
					  .low = bindings[0].buffer->mapped,
					  .high = bindings[1].buffer->mapped,
					  .payload = bindings[2].buffer->mapped,
					  .counts = bindings[3].buffer->mapped,
					  .low_out = bindings[4].buffer->mapped,
					  .high_out = bindings[5].buffer->mapped,
					  .payload_out = bindings[6].buffer->mapped };
	gw_parallel_for(passes->threads, (size_t)count, 1, scatter_runs, &job);
}
