/* key_sort.c - see key_sort.h: radix sort, the least significant digit first. */
#include "base/key_sort.h"

#include "base/memory.h"
#include "glowworm_host.h"

#include <stdlib.h>

#define DIGIT_BITS 11
#define DIGITS (1u << DIGIT_BITS)
#define PART_LEAST 16384 /* elements: below it threads cost more than they save */

typedef struct key_sort {
	gw_keyed *from, *to;
	size_t count, part; /* elements, and those of one part */
	unsigned shift;
	uint32_t *place; /* DIGITS a part: how many have the digit; then where the next one goes */
} key_sort;

static unsigned digit_of(const key_sort *sort, size_t i)
{
	return (unsigned)(sort->from[i].key >> sort->shift) & (DIGITS - 1);
}

static void count_digits(void *user, size_t first, size_t last, uint32_t worker)
{
	const key_sort *sort = user;
	uint32_t *own = sort->place + first / sort->part * DIGITS;
	(void)worker;
	for (unsigned digit = 0; digit < DIGITS; digit++)
		own[digit] = 0;
	for (size_t i = first; i < last; i++)
		own[digit_of(sort, i)]++;
}

static void move_elements(void *user, size_t first, size_t last, uint32_t worker)
{
	const key_sort *sort = user;
	uint32_t *own = sort->place + first / sort->part * DIGITS;
	(void)worker;
	for (size_t i = first; i < last; i++)
		sort->to[own[digit_of(sort, i)]++] = sort->from[i];
}

/* From how many of each part have a digit to where the first of them goes; false when all have the
 * same. */
static bool find_places(const key_sort *sort)
{
	size_t parts = (sort->count + sort->part - 1) / sort->part;
	uint32_t sum = 0;
	for (unsigned digit = 0; digit < DIGITS; digit++) {
		uint32_t before = sum;
		for (size_t part = 0; part < parts; part++) {
			uint32_t own = sort->place[part * DIGITS + digit];
			sort->place[part * DIGITS + digit] = sum;
			sum += own;
		}
		if (sum - before == sort->count)
			return false;
	}
	return true;
}

bool gw_sort_keyed(gw_keyed **sorted, size_t count, unsigned bits, uint32_t threads)
{
	key_sort sort = { .from = *sorted, .count = count };
	threads = gw_thread_count(threads);
	sort.part = count / threads + 1 > PART_LEAST ? count / threads + 1 : PART_LEAST;
	if (count < 2)
		return true;
	sort.to = gw_allocate_array(count, sizeof *sort.to);
	sort.place = gw_allocate_array(count / sort.part + 1, DIGITS * sizeof *sort.place);
	bool good = sort.to && sort.place;
	for (; good && sort.shift < bits; sort.shift += DIGIT_BITS) {
		gw_parallel_for(threads, count, sort.part, count_digits, &sort);
		if (!find_places(&sort))
			continue;
		gw_parallel_for(threads, count, sort.part, move_elements, &sort);
		gw_keyed *swap = sort.from;
		sort.from = sort.to;
		sort.to = swap;
	}
	*sorted = sort.from;
	free(sort.to);
	free(sort.place);
	return good;
}
