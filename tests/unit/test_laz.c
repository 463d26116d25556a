/*
 * LAZ: the arithmetic decoder against an encoder written here from Said's report, the running
 * median against sorting, whole files that LASzip made against the points that they were made
 * from, and what the encoder makes of those points against the files; any points there and back.
 */
#include "las/las_format.h"
#include "one_processor.h"
#include "las/las_header.h"
#include "las/laz_channel.h"
#include "las/laz_points.h"
#include "points/scan_shift.h"
#include "laz_samples.h"
#include "las/laz_values.h"
#include "files/little_endian.h"

#include <math.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static uint64_t next_random(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state;
}

/* ------------------------------------------------------------------------------- an encoder */

/* Counts of an alphabet, the plain way: shares of 2^15 are taken anew for every symbol. */
typedef struct counts {
	uint32_t symbols, count[1024], frozen[1024], total, frozen_total, cycle, left;
} counts;

static void freeze(counts *c)
{
	if (c->total > 32768) {
		c->total = 0;
		for (uint32_t s = 0; s < c->symbols; s++)
			c->total += c->count[s] = (c->count[s] + 1) / 2;
	}
	memcpy(c->frozen, c->count, sizeof c->frozen);
	c->frozen_total = c->total;
}

static void start_counts(counts *c, uint32_t symbols)
{
	*c = (counts){ .symbols = symbols, .total = symbols };
	for (uint32_t s = 0; s < symbols; s++)
		c->count[s] = 1;
	freeze(c);
	c->cycle = c->left = (symbols + 6) / 2;
}

static void count_symbol(counts *c, uint32_t symbol)
{
	c->count[symbol]++;
	c->total++;
	if (--c->left > 0)
		return;
	freeze(c);
	uint32_t longest = (c->symbols + 6) * 8;
	c->cycle = c->cycle * 5 / 4 < longest ? c->cycle * 5 / 4 : longest;
	c->left = c->cycle;
}

static uint32_t share(const counts *c, uint32_t symbol)
{
	uint32_t sum = 0;
	for (uint32_t s = 0; s < symbol; s++)
		sum += c->frozen[s];
	return (uint32_t)((uint64_t)(0x80000000u / c->frozen_total) * sum >> 16);
}

/* The interval's base as bytes, to which carries are added, and its length. */
typedef struct encoder {
	uint8_t out[1 << 17];
	size_t used;
	uint32_t base, length;
} encoder;

static void add_to_base(encoder *e, uint32_t offset)
{
	uint32_t sum = e->base + offset;
	for (size_t at = e->used; sum < e->base && at > 0 && ++e->out[at - 1] == 0;)
		at--;
	e->base = sum;
}

static void narrow(encoder *e)
{
	while (e->length < 1u << 24) {
		assert_true(e->used < sizeof e->out);
		e->out[e->used++] = (uint8_t)(e->base >> 24);
		e->base <<= 8;
		e->length <<= 8;
	}
}

static void encode_symbol(encoder *e, counts *c, uint32_t symbol)
{
	uint32_t step = e->length >> 15, low = share(c, symbol) * step;
	uint32_t high = symbol + 1 < c->symbols ? share(c, symbol + 1) * step : e->length;
	add_to_base(e, low);
	e->length = high - low;
	narrow(e);
	count_symbol(c, symbol);
}

static void encode_bits(encoder *e, uint32_t value, uint32_t bits)
{
	if (bits > 19) {
		encode_bits(e, value & 0xffff, 16);
		encode_bits(e, value >> 16, bits - 16);
		return;
	}
	e->length >>= bits;
	add_to_base(e, value * e->length);
	narrow(e);
}

/* Any number in the interval will do: its base, rounded up where the length allows. */
static void finish(encoder *e)
{
	add_to_base(e, e->length / 2);
	for (int b = 0; b < 4; b++, e->base <<= 8)
		e->out[e->used++] = (uint8_t)(e->base >> 24);
}

static void symbols_come_back(void **state)
{
	(void)state;
	static const uint32_t alphabets[] = { 2, 3, 5, 16, 17, 33, 64, 128, 256, 515, 516 };
	enum { KINDS = sizeof alphabets / sizeof *alphabets, COUNT = 30000 };
	static counts c[KINDS];
	static encoder e;
	static uint32_t sent[COUNT];
	for (int skewed = 0; skewed < 2; skewed++) {
		uint64_t random = 7;
		e.used = 0, e.base = 0, e.length = UINT32_MAX;
		for (int k = 0; k < KINDS; k++)
			start_counts(&c[k], alphabets[k]);
		for (size_t i = 0; i < COUNT; i++) {
			uint32_t n = alphabets[i % KINDS], r = (uint32_t)(next_random(&random) >> 20);
			sent[i] = skewed && r % 50 ? n / 3 : r % n;
			encode_symbol(&e, &c[i % KINDS], sent[i]);
			encode_bits(&e, sent[i] * 2654435761u >> (32 - 1 - i % 31), 1 + (uint32_t)(i % 31));
		}
		finish(&e);
		laz_pool pool = { 0 };
		laz_coder d;
		laz_model *model[KINDS] = { 0 };
		laz_coder_decode(&d, e.out, e.used, &pool);
		for (size_t i = 0; i < COUNT; i++) {
			assert_int_equal(laz_symbol(&d, &model[i % KINDS], alphabets[i % KINDS], 0), sent[i]);
			assert_int_equal(laz_bits(&d, 1 + (uint32_t)(i % 31), 0),
							 sent[i] * 2654435761u >> (32 - 1 - i % 31));
		}
		assert_false(d.failed);
		assert_true(d.over <= 4);
		laz_pool_clear(&pool);
	}
}

/* An end that comes too soon is counted, not read over, and nothing hangs. */
static void bytes_run_out(void **state)
{
	(void)state;
	laz_pool pool = { 0 };
	laz_coder d;
	laz_model *model = NULL;
	laz_bit_model bit = { 0 };
	const uint8_t bytes[6] = { 0xff, 0xff, 0xff, 0xff, 0xff, 0xff };
	laz_coder_decode(&d, bytes, sizeof bytes, &pool);
	for (int i = 0; i < 1000; i++) {
		assert_true(laz_symbol(&d, &model, 256, 0) < 256);
		assert_true(laz_bit(&d, &bit, 0) < 2);
		laz_bits(&d, 17, 0);
	}
	assert_true(d.over > 1000);
	laz_pool_clear(&pool);
}

static int compare(const void *a, const void *b)
{
	int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
	return (x > y) - (x < y);
}

/* Against sorting: out goes the largest while new values lie below the median, and from one that
 * does not on the smallest, until one does not lie above it. */
static void median_runs(void **state)
{
	(void)state;
	laz_median median = { 0 };
	int32_t sorted[5] = { 0 };
	bool smallest = false;
	uint64_t random = 99;
	for (int turn = 0; turn < 5000; turn++) {
		int32_t value = (int32_t)(next_random(&random) % 41) - 20, middle = sorted[2];
		sorted[smallest ? 0 : 4] = value;
		qsort(sorted, 5, sizeof *sorted, compare);
		smallest = smallest ? value > middle : value >= middle;
		laz_median_add(&median, value);
		assert_memory_equal(median.sorted, sorted, sizeof sorted);
		assert_int_equal(laz_median_value(&median), sorted[2]);
	}
}

/* ------------------------------------------------------------------------------ whole files */

static scan read_bytes(const uint8_t *file, size_t length)
{
	input_file in = { .name = "sample", .data = file, .length = length };
	scan cloud;
	gw_error error = { 0 };
	if (las_read(&in, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return cloud;
}

static void same_columns(const scan *a, const scan *b, const char *what)
{
	assert_int_equal(a->count, b->count);
	assert_int_equal(a->column_count, b->column_count);
	for (size_t c = 0; c < a->column_count; c++) {
		const scan_column *one = &a->column[c], *other = scan_find(b, one->name);
		if (!other || one->type != other->type ||
			memcmp(one->data, other->data, a->count * scan_type_size(one->type)) != 0)
			fail_msg("%s: column %s differs", what, one->name);
	}
}

static void files_of_laszip(void **state)
{
	(void)state;
	static uint8_t packed[LAZ_SAMPLE_BYTES], plain[LAZ_SAMPLE_BYTES];
	for (int s = 0; s < LAZ_SAMPLES; s++) {
		const laz_sample *sample = &laz_samples[s];
		size_t length = laz_sample_packed(sample, packed);
		scan from_packed = read_bytes(packed, length);
		size_t plain_length = laz_sample_plain(sample->format, sample->extra, plain);
		scan from_plain = read_bytes(plain, plain_length);
		assert_true(length < plain_length);
		same_columns(&from_packed, &from_plain, sample->name);
		/* And they are what the formula says, not only alike. */
		uint8_t record[100];
		for (unsigned i = 0; i < LAZ_SAMPLE_POINTS; i++) {
			laz_sample_record(sample->format, sample->extra, i, record);
			double x = (int32_t)load_32(record) * 0.001 + 400000.0;
			assert_true(scan_value(scan_find(&from_packed, "x"), i) == x);
			assert_true(scan_value(scan_find(&from_packed, "intensity"), i) ==
						load_16(record + 12));
		}
		scan_clear(&from_packed);
		scan_clear(&from_plain);
	}
}

/* The same on one processor as on all. */
static void any_number_of_threads(void **state)
{
	(void)state;
	static uint8_t packed[LAZ_SAMPLE_BYTES];
	size_t length = laz_sample_packed(&laz_samples[1], packed);
	scan all = read_bytes(packed, length);
	cpu_set_t before;
	keep_to_one_processor(&before);
	scan single = read_bytes(packed, length);
	sched_setaffinity(0, sizeof before, &before);
	same_columns(&all, &single, "threads");
	scan_clear(&all);
	scan_clear(&single);
}

/* Which columns of a part hold nothing, as far as it goes. */
static void note_zeros(const scan *part, bool *zero)
{
	for (size_t c = 0; c < part->column_count; c++)
		for (size_t i = 0; i < part->count; i++)
			zero[c] = zero[c] && scan_value(&part->column[c], i) == 0.0;
}

/* Waveforms have numbers of 64 bits, of which all have to be seen. */
static bool can_be_parted(unsigned kind)
{
	return kind < 4 || (kind > 5 && kind < 9);
}

/* Reads a file by seven points at a time, in the middle of chunks too, against all of it. */
static void read_in_parts(input_file *in, const scan *whole, const char *what)
{
	gw_error error;
	uint64_t together;
	bool zero[64];
	scan part;
	memset(zero, true, sizeof zero);
	assert_int_equal(las_count_rows(in, &together), LAZ_SAMPLE_POINTS);
	assert_in_range(together, 1, LAZ_SAMPLE_POINTS);
	for (size_t first = 0; first < LAZ_SAMPLE_POINTS; first += 7) {
		assert_int_equal(las_read_rows(in, &(format_rows){ first, 7 }, &part, &error), GW_OK);
		assert_int_equal(part.count, LAZ_SAMPLE_POINTS - first < 7 ? LAZ_SAMPLE_POINTS - first : 7);
		for (size_t c = 0; c < whole->column_count; c++) {
			size_t size = scan_type_size(whole->column[c].type);
			if (memcmp(scan_find(&part, whole->column[c].name)->data,
					   (const char *)whole->column[c].data + first * size, part.count * size) != 0)
				fail_msg("%s: column %s differs from point %zu on", what, whole->column[c].name,
						 first);
		}
		note_zeros(&part, zero);
		scan_clear(&part);
	}
	/* Columns that hold nothing go by what all parts had. */
	assert_int_equal(las_read_rows(in, &(format_rows){ 0, UINT64_MAX }, &part, &error), GW_OK);
	assert_true(part.column_count > whole->column_count);
	format_seen seen = { .zero = zero };
	for (int k = 0; k < 3; k++) {
		seen.minimum[k] = INFINITY;
		seen.maximum[k] = -INFINITY;
	}
	scan_shift_bounds(&part, seen.minimum, seen.maximum);
	assert_int_equal(las_settle_rows(in, &seen, &part, &error), GW_OK);
	same_columns(&part, whole, what);
	scan_clear(&part);
}

static void files_in_parts(void **state)
{
	(void)state;
	int parted = 0;
	static uint8_t packed[LAZ_SAMPLE_BYTES], plain[LAZ_SAMPLE_BYTES];
	for (int s = 0; s < LAZ_SAMPLES; s++) {
		const laz_sample *sample = &laz_samples[s];
		input_file in = { .name = "packed", .data = packed };
		in.length = laz_sample_packed(sample, packed);
		uint64_t together;
		if (!can_be_parted(sample->format)) {
			assert_int_equal(las_count_rows(&in, &together), 0);
			continue;
		}
		parted++;
		scan whole = read_bytes(packed, in.length);
		read_in_parts(&in, &whole, sample->name);
		in.data = plain;
		in.length = laz_sample_plain(sample->format, sample->extra, plain);
		read_in_parts(&in, &whole, "plain");
		scan_clear(&whole);
	}
	assert_true(parted > 0);
}

/* ---------------------------------------------------------------------------------- encoding */

/* The items of a sample, as its LASzip record lists them. */
static laz_items items_of(const laz_sample *sample, const uint8_t *vlr)
{
	size_t record = laz_sample_record_bytes(sample->format) + sample->extra;
	laz_items items = laz_items_make(sample->format, record);
	for (size_t i = 0; i < items.count; i++)
		items.item[i].version = load_16(vlr + LAZ_VLR_BYTES + i * LAZ_VLR_ITEM_BYTES + 4);
	return items;
}

/* How many points each chunk has, by the table. */
static size_t chunk_counts(const uint8_t *vlr, const uint8_t *table, uint32_t count[30])
{
	laz_pool pool = { 0 };
	laz_coder d;
	laz_integer integer = { 0 };
	laz_model *context[2] = { 0 };
	uint32_t size = load_32(vlr + 12), chunks = load_32(table + 4);
	int32_t length = 0, points = 0;
	laz_coder_decode(&d, table + 8, 100, &pool);
	for (uint32_t c = 0; c < chunks; c++) {
		if (size == LAZ_VARIABLE)
			points = laz_near(&d, &integer, &context[0], 32, points, 0);
		length = laz_near(&d, &integer, &context[1], 32, length, 0);
		count[c] = size == LAZ_VARIABLE ? (uint32_t)points : size;
	}
	laz_pool_clear(&pool);
	return chunks;
}

/* Encodes points and compares them with what LASzip made of them. Returns how many bytes. */
static size_t same_chunk(laz_points *points, const laz_sample *sample, unsigned first,
						 unsigned count, const uint8_t *expected)
{
	uint8_t record[100], bytes[LAZ_SAMPLE_BYTES];
	laz_points_begin(points);
	for (unsigned i = first; i < first + count; i++) {
		laz_sample_record(sample->format, sample->extra, i, record);
		laz_points_add(points, record);
	}
	size_t length = laz_points_end(points);
	assert_in_range(length, 1, sizeof bytes);
	laz_points_put(points, bytes);
	for (size_t b = 0; b < length; b++)
		if (bytes[b] != expected[b])
			fail_msg("%s: byte %zu of %zu from point %u on differs", sample->name, b, length,
					 first);
	return length;
}

/* Byte for byte what LASzip makes of the same points, but for version 1, which is not written. */
static void chunks_of_laszip(void **state)
{
	(void)state;
	static uint8_t packed[LAZ_SAMPLE_BYTES];
	for (int s = 1; s < LAZ_SAMPLES; s++) {
		const laz_sample *sample = &laz_samples[s];
		laz_sample_packed(sample, packed);
		size_t start = load_32(packed + 96), at = start + 8, table = load_32(packed + start);
		const uint8_t *vlr = packed + load_16(packed + 94) + 54;
		laz_items items = items_of(sample, vlr);
		laz_points *points = laz_points_create(&items);
		uint32_t count[30];
		size_t chunks = chunk_counts(vlr, packed + table, count);
		unsigned first = 0;
		for (size_t c = 0; c < chunks; c++) {
			unsigned rest = LAZ_SAMPLE_POINTS - first, n = count[c] < rest ? count[c] : rest;
			at += same_chunk(points, sample, first, n, packed + at);
			first += n;
		}
		assert_int_equal(first, LAZ_SAMPLE_POINTS);
		assert_int_equal(at, table);
		laz_points_destroy(&points);
	}
}

/* Bytes of the next point: all of them other ones, or one in eight, or one in sixty. */
static void change_record(uint8_t *record, size_t length, int mode, uint64_t *random)
{
	static const uint64_t one_in[3] = { 1, 8, 60 };
	for (size_t b = 0; b < length; b++)
		if (next_random(random) % one_in[mode] == 0)
			record[b] = (uint8_t)(next_random(random) >> 40);
}

/* Points of a format, encoded and decoded again. */
static void come_back(const laz_items *items, size_t count, int mode)
{
	uint8_t *records = malloc(count * items->record), got[100] = { 0 };
	uint64_t random = 1 + items->record;
	laz_points *points = laz_points_create(items);
	laz_points_begin(points);
	for (size_t i = 0; i < count; i++) {
		uint8_t *record = records + i * items->record;
		memcpy(record, i ? record - items->record : got, items->record);
		change_record(record, items->record, mode, &random);
		memcpy(got, record, items->record);
		laz_points_add(points, got);
		assert_memory_equal(got, record, items->record);
	}
	size_t length = laz_points_end(points);
	uint8_t *bytes = malloc(length);
	laz_points_put(points, bytes);
	assert_true(laz_points_start(points, bytes, length, count));
	for (size_t i = 0; i < count; i++) {
		laz_points_next(points, got);
		assert_memory_equal(got, records + i * items->record, items->record);
	}
	assert_int_equal(laz_points_trouble(points), LAZ_FINE);
	laz_points_destroy(&points);
	free(bytes);
	free(records);
}

/* Every bit of a point may be anything: channels, returns, times that are no numbers. */
static void any_points_come_back(void **state)
{
	(void)state;
	for (unsigned format_number = 0; format_number < LAS_FORMATS; format_number++)
		for (int mode = 0; mode < 3; mode++) {
			laz_items items = laz_items_make(format_number, las_format_bytes(format_number) + 3);
			for (size_t i = 0; i < items.count; i++)
				items.item[i].version = items.item[i].type == LAZ_WAVEPACKET13 ? 1
										: items.layered                        ? 3
																			   : 2;
			come_back(&items, 1, mode);
			come_back(&items, 1500, mode);
		}
}

/* What never changes takes nothing but its length, 0. */
static void constant_layers_are_left_out(void **state)
{
	(void)state;
	laz_items items = laz_items_make(7, las_format_bytes(7) + 2);
	for (size_t i = 0; i < items.count; i++)
		items.item[i].version = 3;
	uint8_t record[38] = { 0 }, bytes[4096];
	laz_points *points = laz_points_create(&items);
	memset(record + 14, 0x11, sizeof record - 14); /* all but coordinates and intensity */
	laz_points_begin(points);
	for (uint32_t i = 0; i < 200; i++) {
		store_32(record, i * i);
		laz_points_add(points, record);
	}
	assert_in_range(laz_points_end(points), 1, sizeof bytes);
	laz_points_put(points, bytes);
	const uint8_t *sizes = bytes + sizeof record + 4;
	for (size_t layer = 0; layer < LAZ_LAYER_COUNT + 1 + 2; layer++)
		assert_true((load_32(sizes + 4 * layer) > 0) == (layer <= LAZ_LAYER_Z));
	laz_points_destroy(&points);
}

/* ---------------------------------------------------------------------------------- refusals */

static void refused(uint8_t *file, size_t length, const char *because)
{
	input_file in = { .name = "sample.laz", .data = file, .length = length };
	scan cloud;
	gw_error error = { 0 };
	assert_int_equal(las_read(&in, &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "sample.laz"));
	if (!strstr(error.text, because))
		fail_msg("'%s' does not say '%s'", error.text, because);
}

/* Sentences say what cannot be read. */
static void what_is_unsupported(void **state)
{
	(void)state;
	uint8_t file[LAZ_SAMPLE_BYTES];
	size_t length = laz_sample_packed(&laz_samples[1], file);
	size_t vlr = 227 + 54;
	file[vlr] = 4;
	refused(file, length, "compressor 4");
	laz_sample_packed(&laz_samples[1], file);
	file[vlr + 2] = 1;
	refused(file, length, "coder 1");
	laz_sample_packed(&laz_samples[1], file);
	file[vlr + 34 + 4] = 7;
	refused(file, length, "POINT10 (6) of 20 bytes, version 7");
	laz_sample_packed(&laz_samples[1], file);
	store_32(file + vlr + 12, 0);
	refused(file, length, "0 points");
	laz_sample_packed(&laz_samples[1], file);
	store_32(file + 107, 37);
	refused(file, length, "37 points, but the 3 chunks have 36");
	laz_sample_packed(&laz_samples[1], file);
	store_32(file + 107, 31);
	refused(file, length, "7 points in 124 bytes, ends before its last point");
	laz_sample_packed(&laz_samples[1], file);
	store_32(file + 107, 4000000000u);
	refused(file, length, "4000000000");
	laz_sample_packed(&laz_samples[1], file);
	memset(file + 227 + 2, 'x', 16);
	refused(file, length, "no LASzip record");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(symbols_come_back),
		cmocka_unit_test(bytes_run_out),
		cmocka_unit_test(median_runs),
		cmocka_unit_test(files_of_laszip),
		cmocka_unit_test(any_number_of_threads),
		cmocka_unit_test(files_in_parts),
		cmocka_unit_test(chunks_of_laszip),
		cmocka_unit_test(any_points_come_back),
		cmocka_unit_test(constant_layers_are_left_out),
		cmocka_unit_test(what_is_unsupported),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
