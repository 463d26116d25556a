/*
 * test_host.c - the CPU's helpers: errors, names, checked arrays, loops over threads.
 */
#include "glowworm.h"
#include "glowworm_host.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

static void test_fail(void **state)
{
	(void)state;
	gw_error error = { 0 };
	assert_int_equal(gw_fail(&error, GW_ERROR_DATA, "line %d of %s", 7, "cave.ply"), GW_ERROR_DATA);
	assert_int_equal(error.status, GW_ERROR_DATA);
	assert_string_equal(error.text, "line 7 of cave.ply");
	assert_int_equal(gw_fail(NULL, GW_ERROR_MEMORY, "dropped"), GW_ERROR_MEMORY);

	char *text = malloc(2 * GW_ERROR_TEXT);
	assert_non_null(text);
	memset(text, 'x', 2 * GW_ERROR_TEXT - 1);
	text[2 * GW_ERROR_TEXT - 1] = '\0';
	gw_fail(&error, GW_ERROR_DATA, "%s", text);
	assert_int_equal(strlen(error.text), GW_ERROR_TEXT - 1);
	free(text);
}

static void test_names(void **state)
{
	(void)state;
	for (int i = 0; i < GW_METHOD_COUNT; i++)
		for (int j = 0; j < i; j++)
			assert_string_not_equal(gw_method_name((gw_method)i), gw_method_name((gw_method)j));
	for (int i = 0; i < GW_SHADOWS_COUNT; i++)
		for (int j = 0; j < i; j++)
			assert_string_not_equal(gw_shadows_name((gw_shadows)i), gw_shadows_name((gw_shadows)j));
	for (int i = 0; i < GW_EFFECT_KIND_COUNT; i++)
		for (int j = 0; j < i; j++)
			assert_string_not_equal(gw_effect_name((gw_effect_kind)i),
									gw_effect_name((gw_effect_kind)j));
	for (int i = 0; i < GW_LIGHT_TYPE_COUNT; i++)
		for (int j = 0; j < i; j++)
			assert_string_not_equal(gw_light_type_name((gw_light_type)i),
									gw_light_type_name((gw_light_type)j));
	assert_string_equal(gw_light_type_name(GW_LIGHT_SUN), "sun");
}

/* Whether the system was advised to hold an address in huge pages: `hg` among the flags of its
 * mapping, proc(5). */
static bool is_advised_huge(const void *address)
{
	FILE *file = fopen("/proc/self/smaps", "re");
	assert_non_null(file);
	char line[512], end;
	unsigned long from, to;
	bool here = false, advised = false;
	while (fgets(line, sizeof line, file) != NULL) {
		if (sscanf(line, "%lx-%lx%c", &from, &to, &end) == 3)
			here = from <= (unsigned long)address && (unsigned long)address < to;
		else if (here && strncmp(line, "VmFlags:", 8) == 0)
			advised = strstr(line, " hg") != NULL;
	}
	fclose(file);
	return advised;
}

/* Large arrays lie in huge pages, small ones do not ask; where the system has none it is not asked
 * in vain. */
static void test_huge_pages(void **state)
{
	(void)state;
	if (access("/sys/kernel/mm/transparent_hugepage/enabled", F_OK) != 0)
		return;
	const size_t large = (size_t)64 << 20;
	char *array[] = { gw_allocate_array(large, 1), gw_allocate_zeros(large, 1),
					  gw_resize_array(gw_allocate_array(1000, 1), large, 1) };
	for (int i = 0; i < 3; i++) {
		assert_non_null(array[i]);
		assert_true(is_advised_huge(array[i] + large / 2));
		free(array[i]);
	}
	char *small = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	assert_ptr_not_equal(small, MAP_FAILED);
	gw_wish_huge_pages(small, 4096);
	assert_false(is_advised_huge(small));
	gw_wish_huge_pages(NULL, large);
	munmap(small, 4096);
}

static void test_arrays(void **state)
{
	(void)state;
	/* Products that wrap around to something small must not be allocated. */
	volatile size_t half = SIZE_MAX / 2 + 1;
	assert_null(gw_allocate_array(half, 2));
	assert_null(gw_allocate_zeros(half, 4));
	assert_null(gw_resize_array(NULL, half, 2));
	assert_null(gw_allocate_array(half, 1));

	free(gw_allocate_array(3, 8));
	void *none = gw_allocate_array(0, 8);
	assert_non_null(none);
	free(none);
	uint32_t *array = gw_allocate_zeros(100, sizeof *array);
	assert_non_null(array);
	for (uint32_t i = 0; i < 100; i++)
		assert_int_equal(array[i], 0);
	array[99] = 7;
	uint32_t *larger = gw_resize_array(array, 100000, sizeof *array);
	assert_non_null(larger);
	assert_int_equal(larger[99], 7);
	free(larger);
	assert_true(gw_available_memory() > 0);
}

static void test_clock(void **state)
{
	(void)state;
	double before = gw_seconds();
	for (int i = 0; i < 1000; i++) {
		double now = gw_seconds();
		assert_true(now >= before);
		before = now;
	}
}

typedef struct visit {
	uint32_t threads;
	size_t chunk, elements;
	uint32_t *seen; /* how often each element was visited */
	bool bad;
} visit;

static void count_visits(void *user, size_t first, size_t last, uint32_t worker)
{
	visit *job = user;
	if (first % job->chunk != 0 || last <= first || last > job->elements ||
		(last - first != job->chunk && last != job->elements) || worker >= job->threads)
		__atomic_store_n(&job->bad, true, __ATOMIC_RELAXED);
	for (size_t i = first; i < last; i++)
		__atomic_add_fetch(&job->seen[i], 1, __ATOMIC_RELAXED);
}

static void test_parallel_for(void **state)
{
	(void)state;
	static const uint32_t threads[] = { 1, 2, 7, GW_THREADS_MAX };
	static const size_t elements[] = { 0, 1, 63, 64, 65, 10007 };
	uint32_t seen[10007];
	for (size_t t = 0; t < 4; t++)
		for (size_t e = 0; e < 6; e++)
			for (size_t chunk = 1; chunk <= 4096; chunk *= 64) {
				visit job = {
					.threads = threads[t], .chunk = chunk, .elements = elements[e], .seen = seen
				};
				memset(seen, 0, sizeof seen);
				gw_parallel_for(threads[t], elements[e], chunk, count_visits, &job);
				assert_false(job.bad);
				for (size_t i = 0; i < 10007; i++)
					assert_int_equal(seen[i], i < elements[e]);
			}
	assert_true(gw_thread_count(0) >= 1);
	assert_int_equal(gw_thread_count(3), 3);
	assert_int_equal(gw_thread_count(UINT32_MAX), GW_THREADS_MAX);
}

/* No exponent that nobody reads, and no digit that rounding made up. */
static void numbers_are_said(void **state)
{
	(void)state;
	static const struct {
		double value;
		int digits;
		const char *text;
	} row[] = {
		{ 0.0, 4, "0" },
		{ 12345.0, 4, "12340" },
		{ 12345.0, 15, "12345" },
		{ 999.96, 4, "1000" },
		{ -0.00025, 3, "-0.00025" },
		{ 2.5e-7, 3, "2.5e-7" },
		{ 5300000.0, 6, "5.3 million" },
		{ 999999.5, 6, "1 million" },
		{ 16777216.0, 15, "16777216" },
		{ -1e9, 6, "-1 billion" },
		{ 1e14, 15, "100 trillion" },
		{ 1e15, 15, "1e15" },
		{ 1e300, 15, "1e300" },
		{ INFINITY, 4, "inf" },
		{ -NAN, 4, "nan" },
	};
	static const struct {
		double value;
		const char *text;
	} place[] = {
		{ 5300000.4567, "5300000.457" },
		{ -1e9, "-1000000000" },
		{ 0.1234567, "0.123457" },
		{ 0.0, "0" },
	};
	for (size_t r = 0; r < sizeof row / sizeof *row; r++)
		assert_string_equal(GW_SAID(row[r].value, row[r].digits), row[r].text);
	for (size_t r = 0; r < sizeof place / sizeof *place; r++)
		assert_string_equal(GW_SAID_PLACE(place[r].value), place[r].text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_fail),        cmocka_unit_test(test_names),
		cmocka_unit_test(test_arrays),      cmocka_unit_test(test_huge_pages),
		cmocka_unit_test(test_clock),       cmocka_unit_test(test_parallel_for),
		cmocka_unit_test(numbers_are_said),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
