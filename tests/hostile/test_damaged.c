/*
 * Damaged files: every reader gets every truncated length, lies in every count, and some thousands
 * of overwritten windows, each in memory of exactly the file's length, so that a sanitizer sees a
 * byte too many. A reader may accept what it gets or refuse it with a sentence that names the file;
 * it must not crash, leak, or ask for more memory than the file justifies.
 */
#include "counted_memory.h"
#include "e57_file.h"
#include "scan_sum.h"
#include "seed_files.h"
#include "table/format_table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static seed seeds[SEEDS];

static int make_seeds(void **state)
{
	(void)state;
	seed_files_make(seeds);
	return 0;
}

/* -------------------------------------------------------------------------------- attempts */

/*
 * What a reader may hold at once. A column takes at most 8 bytes for 2 bytes of text; a header's
 * property of 16 bytes or more takes under 160 in tables that double; the constant pays for the
 * rounding up of small blocks.
 */
static size_t allowed(size_t length)
{
	return 16384 + 16 * length;
}

static size_t accepted, refused;

/* How a seed is read some points at a time, or NULL. */
static const format_stream *stream_of(const seed *s)
{
	const format *found = s->format ? format_by_name(s->format) : NULL;
	return found && s->read == found->read ? found->stream : NULL;
}

/* All of a file a few points at a time, as far as it goes. */
static gw_status read_pieces(input_file *in, const format_stream *stream, uint64_t *points,
							 gw_error *error)
{
	void *state = NULL;
	gw_status status = stream->open(in, &state, error);
	bool more = true;
	*points = 0;
	while (status == GW_OK && more) {
		scan piece;
		status = stream->next(state, 3, &piece, error);
		volatile double sum = scan_sum_of_all(&piece);
		(void)sum;
		*points += piece.count;
		more = piece.count > 0;
		scan_clear(&piece);
	}
	stream->close(state);
	return status;
}

/* What can be read so takes no more than all at once, and is as much. */
static void attempt_pieces(const seed *s, const uint8_t *data, size_t length, const char *what,
						   size_t at)
{
	const format_stream *stream = stream_of(s);
	input_file in = { .name = "seed.file", .data = data, .length = length };
	gw_error error = { 0 };
	scan whole;
	uint64_t points;
	if (!stream)
		return;
	gw_status all = s->read(&in, &whole, &error);
	uint64_t count = whole.count;
	scan_clear(&whole);
	counted_memory_reset();
	gw_status status = read_pieces(&in, stream, &points, &error);
	const counted_memory *m = &counted;
	if (status != all || (all == GW_OK && points != count))
		fail_msg("%s, %s %zu: %llu of %llu points by pieces: '%s'", s->name, what, at,
				 (unsigned long long)points, (unsigned long long)count, error.text);
	if (m->peak > allowed(length) || m->largest > allowed(length) || m->live != 0)
		fail_msg("%s, %s %zu: pieces took %zu bytes, %zu at once, left %zu", s->name, what, at,
				 m->peak, m->largest, m->live);
}

static gw_status attempt(const seed *s, const void *data, size_t length, const char *what,
						 size_t at)
{
	uint8_t *copy = uncounted_malloc(s->xml ? E57_FILE_PAGES(length) : length + !length);
	if (s->xml)
		length = e57_file_pages(data, length, s->xml, copy);
	else
		memcpy(copy, data, length);
	if (counted.fail_at < 0)
		attempt_pieces(s, copy, length, what, at);
	input_file in = { .name = "seed.file", .data = copy, .length = length };
	scan cloud;
	gw_error error = { 0 };
	counted_memory_reset();
	gw_status status = s->read(&in, &cloud, &error);
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
	if (m->peak > allowed(length) || m->largest > allowed(length) || m->live != 0)
		fail_msg("%s, %s %zu: took %zu bytes, asked for %zu at once, left %zu", s->name, what, at,
				 m->peak, m->largest, m->live);
	return status;
}

static void seeds_are_good(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		assert_true(s->length <= sizeof s->data);
		if (attempt(s, s->data, s->length, "whole", 0) != GW_OK)
			fail_msg("%s was refused", s->name);
	}
}

static void every_truncation(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		for (size_t length = 0; length < s->length; length++) {
			gw_status status = attempt(s, s->data, length, "cut to", length);
			/* Nothing reads as a whole scan before its last point is there. */
			assert_true(status == GW_ERROR_DATA || length > s->length - 40 || s->open_end);
		}
	}
}

/* Replaces a number in the header by a lie. */
static void lie(const seed *s, size_t start, size_t end, const char *text)
{
	uint8_t data[sizeof s->data + 32];
	size_t size = strlen(text);
	memcpy(data, s->data, start);
	memcpy(data + start, text, size);
	memcpy(data + start + size, s->data + end, s->length - end);
	attempt(s, data, start + size + s->length - end, "lie at", start);
}

static const char *const lies[] = { "0",
									"1",
									"-1",
									"2147483647",
									"2147483648",
									"4294967295",
									"4294967296",
									"9223372036854775807",
									"9223372036854775808",
									"18446744073709551615",
									"18446744073709551616",
									"1e9",
									"12.0" };

static void every_count_in_a_header_lies(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		char more_than_the_file[24];
		snprintf(more_than_the_file, sizeof more_than_the_file, "%zu", s->length + 1);
		for (size_t at = 0; at < s->header; at++) {
			size_t end = at;
			while (end < s->header && s->data[end] >= '0' && s->data[end] <= '9')
				end++;
			if (end == at)
				continue;
			for (size_t l = 0; l < sizeof lies / sizeof *lies; l++)
				lie(s, at, end, lies[l]);
			lie(s, at, end, more_than_the_file);
			at = end;
		}
	}
}

/* The same for numbers in bytes: at every place, in both orders, in 2, 4 and 8 bytes. */
static void every_binary_number_lies(void **state)
{
	(void)state;
	static const uint64_t numbers[] = { 0,          1,          UINT64_MAX, INT32_MAX,
										0x80000000, UINT32_MAX, INT64_MAX,  (uint64_t)1 << 63 };
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		size_t first = s->xml ? 0 : s->header, last = s->xml ? s->xml : s->length;
		for (size_t at = first; at + 8 <= last; at++) {
			for (size_t n = 0; n < 3 * 2 * sizeof numbers / sizeof *numbers; n++) {
				seed damaged = *s;
				damaged.length = at;
				seed_put_number(&damaged, numbers[n / 6], (size_t)2 << n % 3, n / 3 % 2);
				attempt(s, damaged.data, s->length, "number at", at);
			}
		}
	}
}

/* For formats with a binary count the one lie that matters most: one more, one less. */
static void cloud_count_must_agree(void **state)
{
	(void)state;
	const seed *s = &seeds[SEED_CLOUD];
	for (uint64_t count = 0; count < 40; count++) {
		seed damaged = *s;
		damaged.length = 0;
		seed_put_number(&damaged, count, 4, false);
		gw_status status = attempt(s, damaged.data, s->length, "count", count);
		assert_int_equal(status, count == s->points ? GW_OK : GW_ERROR_DATA);
	}
}

static uint64_t next_random(uint64_t *seed_of_sequence)
{
	uint64_t r = *seed_of_sequence;
	r ^= r << 13;
	r ^= r >> 7;
	r ^= r << 17;
	return *seed_of_sequence = r;
}

/* Overwrites 1 to 8 bytes with random ones, or with bytes that mean something to a parser. */
static void windows_of_bytes(void **state)
{
	(void)state;
	static const char special[] = "\0\n\r \t-+.e0129#plyv\x7f\x80\xff";
	uint64_t random = 12345;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		for (size_t turn = 0; turn < 4000; turn++) {
			seed damaged = *s;
			uint64_t r = next_random(&random);
			/* Every other window lies in the header, where there is one. */
			size_t range = turn % 2 && s->header ? s->header : s->length;
			size_t at = (size_t)(r % range), size = 1 + (size_t)(r >> 32) % 8;
			for (size_t k = at; k < at + size && k < s->length; k++) {
				uint64_t pick = next_random(&random);
				damaged.data[k] =
					(uint8_t)(turn % 4 < 2 ? pick : (uint8_t)special[pick % sizeof special]);
			}
			attempt(s, damaged.data, s->length, "window", turn);
		}
	}
	/* The damage reaches the readers in both ways. */
	assert_true(accepted > 100 && refused > 100);
}

/* A header of nothing but properties, elements or comments cannot take much time or memory. */
static void headers_that_swell(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		bool numbered;
	} lines[] = { { "element a 0", false },
				  { "comment", false },
				  { "", false },
				  { "property char ", true },
				  { "property list uchar char ", true } };
	static char text[2 << 20];
	for (size_t l = 0; l < sizeof lines / sizeof *lines; l++) {
		size_t length = (size_t)sprintf(text, "ply\nformat ascii 1.0\nelement vertex 1\n");
		for (size_t i = 0; length + 64 < sizeof text; i++)
			length += lines[l].numbered
						  ? (size_t)sprintf(text + length, "%s%zu\n", lines[l].text, i)
						  : (size_t)sprintf(text + length, "%s\n", lines[l].text);
		assert_int_equal(attempt(&seeds[0], text, length, "swollen", l), GW_ERROR_DATA);
	}
}

static gw_status attempt_whole(void *user, long failing)
{
	const seed *s = user;
	return attempt(s, s->data, s->length, "allocation", (size_t)failing);
}

/* Every allocation fails once: the reader says so and leaves nothing behind. */
/* The same some points at a time. */
static gw_status attempt_whole_pieces(void *user, long failing)
{
	const seed *s = user;
	uint8_t *copy = uncounted_malloc(s->xml ? E57_FILE_PAGES(s->length) : s->length);
	size_t length = s->xml ? e57_file_pages(s->data, s->length, s->xml, copy) : s->length;
	if (!s->xml)
		memcpy(copy, s->data, length);
	input_file in = { .name = "seed.file", .data = copy, .length = length };
	gw_error error = { 0 };
	uint64_t points;
	counted_memory_reset();
	gw_status status = read_pieces(&in, stream_of(s), &points, &error);
	uncounted_free(copy);
	if (counted.live != 0)
		fail_msg("%s, allocation %ld: pieces left %zu bytes", s->name, failing, counted.live);
	return status;
}

static void memory_runs_out(void **state)
{
	(void)state;
	const long least = 10; /* a name and the values of each column */
	for (int i = 0; i < SEEDS; i++) {
		assert_true(counted_memory_exhaust(attempt_whole, &seeds[i]) >= least);
		if (stream_of(&seeds[i]))
			assert_true(counted_memory_exhaust(attempt_whole_pieces, &seeds[i]) >= least);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(seeds_are_good),
		cmocka_unit_test(every_truncation),
		cmocka_unit_test(every_count_in_a_header_lies),
		cmocka_unit_test(every_binary_number_lies),
		cmocka_unit_test(cloud_count_must_agree),
		cmocka_unit_test(windows_of_bytes),
		cmocka_unit_test(headers_that_swell),
		cmocka_unit_test(memory_runs_out),
	};
	return cmocka_run_group_tests(tests, make_seeds, NULL);
}
