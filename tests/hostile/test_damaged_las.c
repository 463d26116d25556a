/*
 * Damaged LAS and LAZ: every truncated length, lies in every number of header, VLRs and table of
 * chunks, and thousands of overwritten windows, each in memory of exactly the file's length. A
 * reader may accept what it gets or refuse it with a sentence that names the file; it must not
 * crash, leak, or ask for more memory than the file justifies.
 */
#include "counted_memory.h"
#include "las/las_format.h"
#include "laz_samples.h"
#include "files/little_endian.h"
#include "scan_sum.h"

#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct seed {
	const char *name;
	uint8_t data[LAZ_SAMPLE_BYTES];
	size_t length;
	size_t points; /* byte where they begin */
	bool packed;
} seed;

enum { SEEDS = LAZ_SAMPLES + 2 };
static seed seeds[SEEDS];

/* Files without VLRs get one that describes their three extra bytes. */
static void make_plain(seed *s, const char *name, unsigned format_number)
{
	uint8_t vlr[54 + 192] = { 0 };
	s->name = name;
	s->length = laz_sample_plain(format_number, 3, s->data);
	s->points = load_32(s->data + 96);
	memcpy(vlr + 2, "LASF_Spec", 9);
	vlr[18] = 4;
	vlr[20] = 192;
	vlr[54 + 2] = 21; /* three bytes */
	vlr[54 + 4] = 'e';
	memmove(s->data + s->points + sizeof vlr, s->data + s->points, s->length - s->points);
	memcpy(s->data + s->points, vlr, sizeof vlr);
	s->length += sizeof vlr;
	s->points += sizeof vlr;
	store_32(s->data + 96, (uint32_t)s->points);
	store_32(s->data + 100, 1);
}

/* One processor, because memory is counted for one thread. */
static int make_seeds(void **state)
{
	(void)state;
	cpu_set_t all, one;
	CPU_ZERO(&one);
	if (sched_getaffinity(0, sizeof all, &all) != 0)
		return -1;
	for (size_t cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
		if (CPU_ISSET(cpu, &all))
			CPU_SET(cpu, &one);
	for (int s = 0; s < LAZ_SAMPLES; s++) {
		seeds[s].name = laz_samples[s].name;
		seeds[s].length = laz_sample_packed(&laz_samples[s], seeds[s].data);
		seeds[s].points = load_32(seeds[s].data + 96);
		seeds[s].packed = true;
	}
	make_plain(&seeds[LAZ_SAMPLES], "las 3", 3);
	make_plain(&seeds[LAZ_SAMPLES + 1], "las 10", 10);
	return sched_setaffinity(0, sizeof one, &one);
}

/*
 * What a reader may hold at once: the constant is for the state of two decoders; the rest for 16
 * points a byte, which LAZ is believed without a trial, in columns of under 200 bytes a point.
 */
static size_t allowed(const seed *s, size_t length)
{
	return s->packed ? ((size_t)3 << 19) + 3200 * length : 32768 + 16 * length;
}

static size_t accepted, refused;

static gw_status attempt(const seed *s, const void *data, size_t length, const char *what,
						 size_t at)
{
	uint8_t *copy = uncounted_malloc(length + !length);
	memcpy(copy, data, length);
	input_file in = { .name = "seed.file", .data = copy, .length = length };
	scan cloud;
	gw_error error = { 0 };
	counted_memory_reset();
	gw_status status = las_read(&in, &cloud, &error);
	uncounted_free(copy);
	if (status == GW_OK) {
		volatile double sum = scan_sum_of_all(&cloud);
		(void)sum;
		scan_clear(&cloud);
		accepted++;
	} else {
		refused++;
		bool empty = !cloud.column && !cloud.comment && cloud.count == 0;
		if (!empty || (status == GW_ERROR_DATA && !strstr(error.text, "seed.file")))
			fail_msg("%s, %s %zu: bad refusal: '%s'", s->name, what, at, error.text);
	}
	const counted_memory *m = &counted;
	if (m->peak > allowed(s, length) || m->live != 0)
		fail_msg("%s, %s %zu: took %zu bytes, asked for %zu at once, left %zu", s->name, what, at,
				 m->peak, m->largest, m->live);
	return status;
}

static void seeds_are_good(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++)
		if (attempt(&seeds[i], seeds[i].data, seeds[i].length, "whole", 0) != GW_OK)
			fail_msg("%s was refused", seeds[i].name);
}

/* Nothing reads as a whole scan before its last point is there; behind it may stand a decoder's
 * last bytes. */
static void every_truncation(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++)
		for (size_t length = 0; length < seeds[i].length; length++)
			if (attempt(&seeds[i], seeds[i].data, length, "cut to", length) != GW_ERROR_DATA &&
				length + 8 < seeds[i].length)
				fail_msg("%s was accepted when cut to %zu bytes", seeds[i].name, length);
}

static void put_number(uint8_t *to, uint64_t number, size_t size)
{
	for (size_t b = 0; b < size; b++)
		to[b] = (uint8_t)(number >> 8 * b);
}

/* Numbers that lie, in 1, 2, 4 and 8 bytes, at every place before the points, in the first and in
 * the last ones, where the table of chunks is. */
static void every_number_lies(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		const uint64_t numbers[] = {
			0, INT32_MAX, 0x80000000, INT64_MAX, UINT64_MAX, s->length + 1
		};
		for (size_t at = 0; at + 8 <= s->length; at++) {
			if (at == s->points + 72 && s->length > at + 64)
				at = s->length - 64;
			for (size_t n = 0; n < 4 * sizeof numbers / sizeof *numbers; n++) {
				seed damaged = *s;
				put_number(damaged.data + at, numbers[n / 4], (size_t)1 << n % 4);
				attempt(s, damaged.data, s->length, "number at", at);
			}
		}
	}
}

static uint64_t next_random(uint64_t *sequence)
{
	*sequence ^= *sequence << 13;
	*sequence ^= *sequence >> 7;
	*sequence ^= *sequence << 17;
	return *sequence;
}

/* Overwrites 1 to 8 bytes with random ones; every other time before the points. */
static void windows_of_bytes(void **state)
{
	(void)state;
	uint64_t random = 12345;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		for (size_t turn = 0; turn < 2500; turn++) {
			seed damaged = *s;
			uint64_t r = next_random(&random);
			size_t at = (size_t)(r >> 8) % (turn % 2 ? s->points : s->length);
			for (size_t size = 1 + r % 8; size > 0 && at < s->length; size--)
				damaged.data[at++] = (uint8_t)next_random(&random);
			attempt(s, damaged.data, s->length, "window", turn);
		}
	}
	assert_true(accepted > 1000 && refused > 1000);
}

/* A count that the bytes cannot hold is found out before memory is taken for the points. */
static void counts_without_end(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		for (unsigned bit = 6; bit < 64; bit++) {
			seed damaged = seeds[i];
			bool old = load_32(damaged.data + 107) != 0;
			if (old && bit > 31)
				break;
			put_number(damaged.data + (old ? 107 : 247), (uint64_t)1 << bit, old ? 4 : 8);
			assert_int_equal(attempt(&damaged, damaged.data, damaged.length, "count 2 to the", bit),
							 GW_ERROR_DATA);
			/* Chunks as large as they can be said to be do not help. */
			if (damaged.packed)
				put_number(damaged.data + (old ? 227 : 375) + 54 + 12, 0xfffffffe, 4);
			assert_int_equal(
				attempt(&damaged, damaged.data, damaged.length, "chunks 2 to the", bit),
				GW_ERROR_DATA);
		}
	}
}

static gw_status attempt_whole(void *user, long failing)
{
	const seed *s = user;
	return attempt(s, s->data, s->length, "allocation", (size_t)failing);
}

/* Every allocation fails once: reader and writer say so and leave nothing behind. */
static void memory_runs_out(void **state)
{
	(void)state;
	const long least = 20; /* a name and the values of each column */
	for (int i = 0; i < SEEDS; i++)
		assert_true(counted_memory_exhaust(attempt_whole, &seeds[i]) >= least);
}

/* A cloud to be written, how and where. */
typedef struct writing {
	gw_status (*write)(output_file *out, const scan *cloud, gw_error *error);
	const char *path;
	scan cloud;
} writing;

static gw_status write_to_nowhere(void *user, long failing)
{
	const writing *w = user;
	output_file *out;
	counted.fail_at = -1;
	assert_int_equal(output_file_create(&out, w->path, true, NULL), GW_OK);
	counted_memory_reset();
	counted.fail_at = failing;
	gw_status status = w->write(out, &w->cloud, NULL);
	counted.fail_at = -1;
	assert_int_equal(counted.live, 0);
	output_file_abandon(&out);
	return status;
}

static void memory_runs_out_for_the_writers(void **state)
{
	(void)state;
	writing all[] = { { las_write, "/dev/null", { 0 } },
					  { laz_write, "/dev/null", { 0 } },
					  { laz_write, "/tmp/glowworm-nowhere.laz", { 0 } },
					  { copc_write, "/dev/null", { 0 } } };
	input_file in = { .name = "seed",
					  .data = seeds[SEEDS - 1].data,
					  .length = seeds[SEEDS - 1].length };
	for (size_t w = 0; w < sizeof all / sizeof *all; w++) {
		assert_int_equal(las_read(&in, &all[w].cloud, NULL), GW_OK);
		assert_true(counted_memory_exhaust(write_to_nowhere, &all[w]) >= (w ? 20 : 5));
		scan_clear(&all[w].cloud);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(seeds_are_good),
		cmocka_unit_test(every_truncation),
		cmocka_unit_test(every_number_lies),
		cmocka_unit_test(windows_of_bytes),
		cmocka_unit_test(counts_without_end),
		cmocka_unit_test(memory_runs_out),
		cmocka_unit_test(memory_runs_out_for_the_writers),
	};
	return cmocka_run_group_tests(tests, make_seeds, NULL);
}
