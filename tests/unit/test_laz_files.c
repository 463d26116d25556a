/*
 * LAZ files that are written: whole chunks and begun ones, every point format, extra bytes of all
 * types, several channels and jumping times, each as LAS has it; the same bytes for any number of
 * threads.
 */
#include "las/las_format.h"
#include "las/las_notes.h"
#include "las/laz_items.h"
#include "laz_clouds.h"
#include "files/little_endian.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

enum { CHUNK = 50000 }; /* as laz_writer.c has it */

static char las_path[64], laz_path[64];

static int make_paths(void **state)
{
	(void)state;
	snprintf(las_path, sizeof las_path, "/tmp/glowworm-laz-%ld.las", (long)getpid());
	snprintf(laz_path, sizeof laz_path, "/tmp/glowworm-laz-%ld.laz", (long)getpid());
	return 0;
}

static int remove_paths(void **state)
{
	(void)state;
	unlink(las_path);
	unlink(laz_path);
	return 0;
}

static void same_columns(const scan *a, const scan *b)
{
	assert_int_equal(a->count, b->count);
	assert_int_equal(a->column_count, b->column_count);
	for (size_t c = 0; c < a->column_count; c++) {
		const scan_column *one = &a->column[c], *other = scan_find(b, one->name);
		if (!other || one->type != other->type ||
			memcmp(one->data, other->data, a->count * scan_type_size(one->type)) != 0)
			fail_msg("column %s of %zu points differs", one->name, a->count);
	}
}

/* Writes a cloud both ways and compares what comes back. */
static void same_as_las(const scan *cloud)
{
	write_cloud(&las_format, las_path, cloud);
	write_cloud(&laz_format, laz_path, cloud);
	scan plain = read_cloud(las_path), packed = read_cloud(laz_path);
	assert_int_equal(packed.count, cloud->count);
	same_columns(&plain, &packed);
	scan_clear(&plain);
	scan_clear(&packed);
}

/* ------------------------------------------------------------------------------------- tests */

/* How many points a file's format byte and LASzip record say there are, and of which kind. */
static void says(unsigned format_number, laz_compressor kind, size_t count)
{
	size_t length;
	uint8_t *file = load_bytes(laz_path, &length);
	assert_int_equal(file[104], format_number | 0x80);
	assert_int_equal(load_64(file + 247), count);
	size_t points = load_32(file + 96);
	/* The LASzip record is the last one. */
	const uint8_t *vlr = file + points - LAZ_VLR_BYTES;
	while (memcmp(vlr - 52, LAS_USER_LASZIP, strlen(LAS_USER_LASZIP)) != 0)
		vlr--;
	assert_int_equal(load_16(vlr), kind);
	assert_int_equal(load_32(vlr + 12), CHUNK);
	uint64_t table = load_64(file + points);
	assert_in_range(table, points + 8, length - 8);
	assert_int_equal(load_32(file + table), 0);
	assert_int_equal(load_32(file + table + 4), (count + CHUNK - 1) / CHUNK);
	free(file);
}

static void whole_and_begun_chunks(void **state)
{
	(void)state;
	static const size_t counts[] = { 0, 1, 2, CHUNK - 1, CHUNK, CHUNK + 1, 2 * CHUNK };
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		scan cloud = make_cloud(counts[c], false);
		same_as_las(&cloud);
		says(6, LAZ_LAYERED, counts[c]);
		scan_clear(&cloud);
	}
}

static void every_format_and_type(void **state)
{
	(void)state;
	for (int wild = 0; wild < 2; wild++)
		for (unsigned number = 6; number <= 8; number++) {
			scan cloud = make_cloud(3000, wild);
			add_pulses(&cloud, wild);
			if (number > 6)
				add_colors(&cloud);
			if (number > 7)
				add_infrared(&cloud);
			add_extra(&cloud);
			same_as_las(&cloud);
			says(number, LAZ_LAYERED, 3000);
			scan_clear(&cloud);
		}
}

static double any_time(size_t i)
{
	return 1e9 * hashed(i / 3, 1);
}

/* Points that came from an old format keep it. */
static void old_formats(void **state)
{
	(void)state;
	for (unsigned number = 0; number < 4; number++) {
		scan cloud = make_cloud(3000, number & 1);
		add_rank(&cloud);
		if (number & 1)
			add_values(&cloud, "gps_time", SCAN_FLOAT64, any_time);
		if (number & 2)
			add_colors(&cloud);
		add_extra(&cloud);
		same_as_las(&cloud);
		says(number, LAZ_CHUNKED, 3000);
		scan_clear(&cloud);
	}
}

static void any_number_of_threads(void **state)
{
	(void)state;
	scan cloud = make_cloud(3 * CHUNK + 1, false);
	same_by_one_processor(&laz_format, laz_path, &cloud);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(whole_and_begun_chunks),
		cmocka_unit_test(every_format_and_type),
		cmocka_unit_test(old_formats),
		cmocka_unit_test(any_number_of_threads),
	};
	return cmocka_run_group_tests(tests, make_paths, remove_paths);
}
