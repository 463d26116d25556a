/*
 * radix_sort.c - see radix_sort.h. One digit at a time: count digits in runs of keys, make the
 * counts places by a prefix sum, and put the keys there.
 */
#include "device/radix_sort.h"

#include "device/named_pass.h"
#include "device/sort_layout.h"
#include "base/parallel.h"

#include <assert.h>
#include <string.h>

#define DIGIT_BITS 8u
_Static_assert(GW_RADIX_DIGITS == 1u << DIGIT_BITS, "a digit has that many values");

/* Keys an invocation: as few as leave work for a wide device, but the counts a small share. */
#define RUN_MIN 64u
#define RUN_MAX 4096u
#define RUNS_WANTED 4096u

gw_status gw_radix_sort_create(gw_gpu *gpu, gw_radix_sort *sort, gw_error *error)
{
	memset(sort, 0, sizeof *sort);
	if (gw_gpu_is_host(gpu))
		return GW_OK;
	gw_status status = gw_prefix_sum_create(gpu, &sort->prefix, error);
	if (status == GW_OK)
		status = gw_named_pass_create(gpu, "radix_count", "TS", sizeof(gw_radix_push), RUN_MAX,
									  &sort->count, error);
	if (status == GW_OK)
		status = gw_named_pass_create(gpu, "radix_scatter", "TTTSSSS", sizeof(gw_radix_push),
									  RUN_MAX, &sort->scatter, error);
	if (status != GW_OK)
		gw_radix_sort_destroy(gpu, sort);
	return status;
}

void gw_radix_sort_destroy(gw_gpu *gpu, gw_radix_sort *sort)
{
	gw_buffer_destroy(gpu, &sort->counts);
	gw_pass_destroy(gpu, &sort->count);
	gw_pass_destroy(gpu, &sort->scatter);
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
		gw_status status = gw_buffer_create(gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT, 4 * count,
											part[i].name, part[i].buffer, error);
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

static gw_status sort_digit(gw_gpu *gpu, gw_radix_sort *sort, gw_sort_list *list,
							gw_radix_push push, gw_error *error)
{
	gw_buffer *word = push.high ? &list->high : &list->low;
	/* A narrow list has no high words; the shader doesn't touch what stands in. */
	gw_buffer *high = list->wide ? &list->high : &list->low;
	gw_buffer *high_copy = list->wide ? &list->high_copy : &list->low_copy;
	GW_TRY(gw_buffer_fill(gpu, &sort->counts, 0, error));
	gw_binding counting[] = { { .buffer = word }, { .buffer = &sort->counts } };
	GW_TRY(gw_pass_run(gpu, sort->count, counting, &push, push.runs, error));
	uint64_t counts = (uint64_t)push.runs * GW_RADIX_DIGITS;
	GW_TRY(gw_prefix_sum_run(gpu, &sort->prefix, &sort->counts, counts, NULL, error));
	gw_binding scattering[] = { { .buffer = &list->low },         { .buffer = high },
								{ .buffer = &list->payload },     { .buffer = &sort->counts },
								{ .buffer = &list->low_copy },    { .buffer = high_copy },
								{ .buffer = &list->payload_copy } };
	GW_TRY(gw_pass_run(gpu, sort->scatter, scattering, &push, push.runs, error));
	swap_copies(list);
	return GW_OK;
}

/* ------------------------------------------------------------------------------ on the host */

#define HOST_RUNS 16u

/* One digit, on a device that is the host's own processor: the same steps over fewer, longer runs.
 */
typedef struct host_digit {
	const uint32_t *word, *low, *high, *payload;
	uint32_t *low_out, *high_out, *payload_out;
	uint32_t shift;
	bool wide, index;
	size_t run;
	uint32_t count[HOST_RUNS][GW_RADIX_DIGITS];
} host_digit;

static uint32_t digit_of(const host_digit *d, size_t i)
{
	return d->word[i] >> d->shift & (GW_RADIX_DIGITS - 1);
}

static void count_run(void *user, size_t first, size_t last, uint32_t worker)
{
	host_digit *d = user;
	uint32_t *count = d->count[first / d->run];
	(void)worker;
	for (size_t i = first; i < last; i++)
		count[digit_of(d, i)]++;
}

/* Counts become the places where each run puts its keys. */
static void make_places(host_digit *d)
{
	uint32_t sum = 0;
	for (size_t digit = 0; digit < GW_RADIX_DIGITS; digit++)
		for (size_t run = 0; run < HOST_RUNS; run++) {
			uint32_t count = d->count[run][digit];
			d->count[run][digit] = sum;
			sum += count;
		}
}

static void scatter_run(void *user, size_t first, size_t last, uint32_t worker)
{
	host_digit *d = user;
	uint32_t *place = d->count[first / d->run];
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint32_t to = place[digit_of(d, i)]++;
		d->low_out[to] = d->low[i];
		if (d->wide)
			d->high_out[to] = d->high[i];
		d->payload_out[to] = d->index ? (uint32_t)i : d->payload[i];
	}
}

static void sort_digit_on_host(gw_sort_list *list, uint32_t bit)
{
	host_digit d = { .word = bit < 32 ? list->low.mapped : list->high.mapped,
					 .low = list->low.mapped,
					 .high = list->high.mapped,
					 .payload = list->payload.mapped,
					 .low_out = list->low_copy.mapped,
					 .high_out = list->high_copy.mapped,
					 .payload_out = list->payload_copy.mapped,
					 .shift = bit % 32,
					 .wide = list->wide,
					 .index = bit == 0,
					 .run = (size_t)list->count / HOST_RUNS + 1 };
	gw_parallel_for(0, (size_t)list->count, d.run, count_run, &d);
	make_places(&d);
	gw_parallel_for(0, (size_t)list->count, d.run, scatter_run, &d);
	swap_copies(list);
}

gw_status gw_radix_sort_run(gw_gpu *gpu, gw_radix_sort *sort, gw_sort_list *list, uint32_t bits,
							gw_error *error)
{
	assert(bits >= 1 && bits <= (list->wide ? 64u : 32u));
	if (list->count == 0)
		return GW_OK;
	if (list->count > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%llu keys cannot be sorted at once: bake with fewer points or a coarser "
					   "octree",
					   (unsigned long long)list->count);
	for (uint32_t bit = 0; bit < bits && sort->count == NULL; bit += DIGIT_BITS)
		sort_digit_on_host(list, bit);
	if (sort->count == NULL)
		return GW_OK;
	uint64_t run = list->count / RUNS_WANTED + 1;
	run = run < RUN_MIN ? RUN_MIN : run > RUN_MAX ? RUN_MAX : run;
	gw_radix_push push = {
		.total = (uint32_t)list->count,
		.run = (uint32_t)run,
		.runs = (uint32_t)((list->count + run - 1) / run),
		.wide = list->wide,
	};
	uint64_t counts = UINT64_C(4) * push.runs * GW_RADIX_DIGITS;
	if (sort->counts.bytes < counts) {
		gw_buffer_destroy(gpu, &sort->counts);
		GW_TRY(gw_buffer_create(gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, counts,
								"counts of digits", &sort->counts, error));
	}
	for (uint32_t bit = 0; bit < bits; bit += DIGIT_BITS) {
		push.shift = bit % 32;
		push.high = bit >= 32;
		push.index = bit == 0;
		GW_TRY(sort_digit(gpu, sort, list, push, error));
	}
	return GW_OK;
}
