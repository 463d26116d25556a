/*
 * LAZ files that are written: whole chunks and begun ones, every point format, extra bytes of all
 * types, several channels and jumping times, each as LAS has it; the same bytes for any number of
 * threads.
 */
#include "las/las_format.h"
#include "las/las_notes.h"
#include "las/laz_items.h"
#include "files/little_endian.h"
#include "table/format_table.h"

#include <math.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

enum { CHUNK = 50000 };

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

static void write_file(const format *f, const char *path, const scan *cloud)
{
	output_file *out;
	gw_error error = { 0 };
	gw_status status = output_file_create(&out, path, true, &error);
	if (status == GW_OK)
		status = f->write(out, cloud, &error);
	if (status == GW_OK)
		status = output_file_commit(&out, &error);
	if (status != GW_OK)
		fail_msg("%s", error.text);
}

static scan read_file(const char *path)
{
	scan cloud;
	gw_error error = { 0 };
	if (format_read(path, NULL, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return cloud;
}

/* Returns the file's bytes, for free(). */
static uint8_t *load(const char *path, size_t *length)
{
	FILE *in = fopen(path, "rb");
	assert_non_null(in);
	assert_int_equal(fseek(in, 0, SEEK_END), 0);
	*length = (size_t)ftell(in);
	rewind(in);
	uint8_t *bytes = malloc(*length);
	assert_int_equal(fread(bytes, 1, *length, in), *length);
	fclose(in);
	return bytes;
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
	write_file(&las_format, las_path, cloud);
	write_file(&laz_format, laz_path, cloud);
	scan plain = read_file(las_path), packed = read_file(laz_path);
	assert_int_equal(packed.count, cloud->count);
	same_columns(&plain, &packed);
	scan_clear(&plain);
	scan_clear(&packed);
}

/* ------------------------------------------------------------------------------------ clouds */

typedef double pattern(size_t i);

static double hashed(size_t i, uint64_t salt)
{
	uint64_t h = (i + 1) * 0x9e3779b97f4a7c15u + salt * 0xbf58476d1ce4e5b9u;
	h = (h ^ h >> 29) * 0x94d049bb133111ebu;
	return (double)(h >> 11) * 0x1p-53;
}

static void add(scan *cloud, const char *name, scan_type type, pattern *value)
{
	gw_error error = { 0 };
	scan_column *column = scan_add_column(cloud, name, type, &error);
	assert_non_null(column);
	for (size_t i = 0; i < cloud->count; i++)
		scan_store(column, i, value(i));
}

/* A scanner's lines on a wavy floor, in steps of a millimetre. */
static double floor_x(size_t i)
{
	return 400000.0 + (double)(i % 311) * 0.012;
}
static double floor_y(size_t i)
{
	return -20.0 + (double)(i / 311) * 0.015;
}
static double floor_z(size_t i)
{
	return round(1000.0 * sin(0.01 * (double)i)) / 1000.0;
}

/* Anywhere that 32 bits of millimetres reach, so that differences go round. */
static double wild_x(size_t i)
{
	return round(4e9 * (hashed(i, 1) - 0.5)) / 1000.0;
}
static double wild_y(size_t i)
{
	return round(4e9 * (hashed(i, 2) - 0.5)) / 1000.0;
}
static double wild_z(size_t i)
{
	return round(4e9 * (hashed(i, 3) - 0.5)) / 1000.0;
}

/* Pulses of three points; and times that leap among five sequences, and at times anywhere. */
static double steady_time(size_t i)
{
	return 123456.0 + 4e-6 * (double)(i / 3);
}
static double leaping_time(size_t i)
{
	double sequence = floor(5.0 * hashed(i / 3, 4)), step = floor(900.0 * hashed(i / 3, 5));
	return i % 97 == 0 ? 1e9 * hashed(i, 6) : 1e4 * sequence * sequence + 1e-6 * step;
}

static double byte_of(size_t i)
{
	return floor(256.0 * hashed(i / 50, 7));
}
static double angle_of(size_t i)
{
	return floor(30000.0 * (hashed(i / 3, 8) - 0.5));
}
static double color_of(size_t i)
{
	return 128.0 + floor(100.0 * sin(0.05 * (double)i));
}
static double returns_of(size_t i)
{
	return 1.0 + floor(15.0 * hashed(i / 3, 9));
}
static double number_of(size_t i)
{
	return 1.0 + (double)(i % 3);
}
static double channel_of(size_t i)
{
	return floor(4.0 * hashed(i / 7, 10));
}
static double flag_of(size_t i)
{
	return (double)(i % 5 == 0);
}
static double real_of(size_t i)
{
	return (double)(float)exp(20.0 * (hashed(i, 11) - 0.5));
}
static double signed_of(size_t i)
{
	return floor(200.0 * (hashed(i, 12) - 0.5));
}

static scan make_cloud(size_t count, bool wild)
{
	scan cloud = { .count = count };
	add(&cloud, "x", SCAN_FLOAT64, wild ? wild_x : floor_x);
	add(&cloud, "y", SCAN_FLOAT64, wild ? wild_y : floor_y);
	add(&cloud, "z", SCAN_FLOAT64, wild ? wild_z : floor_z);
	add(&cloud, "intensity", SCAN_UINT16, byte_of);
	return cloud;
}

static void add_colors(scan *cloud)
{
	add(cloud, "red", SCAN_UINT8, color_of);
	add(cloud, "green", SCAN_UINT8, color_of);
	add(cloud, "blue", SCAN_UINT8, byte_of);
}

static void add_extra(scan *cloud)
{
	static const char *const names[SCAN_TYPE_COUNT] = { "a", "b", "c", "d", "e", "f", "g", "h" };
	for (size_t t = 0; t < SCAN_TYPE_COUNT; t++)
		add(cloud, names[t], (scan_type)t, t < SCAN_FLOAT32 ? number_of : real_of);
	add(cloud, "constant", SCAN_INT16, angle_of);
	add(cloud, "signed", SCAN_INT8, signed_of);
}

static void add_pulses(scan *cloud, bool wild)
{
	add(cloud, "gps_time", SCAN_FLOAT64, wild ? leaping_time : steady_time);
	add(cloud, "return_number", SCAN_UINT8, number_of);
	add(cloud, "number_of_returns", SCAN_UINT8, returns_of);
	add(cloud, "scanner_channel", SCAN_UINT8, channel_of);
	add(cloud, "overlap", SCAN_UINT8, flag_of);
	add(cloud, "edge_of_flight_line", SCAN_UINT8, flag_of);
	add(cloud, "classification", SCAN_UINT8, byte_of);
	add(cloud, "user_data", SCAN_UINT8, byte_of);
	add(cloud, "scan_angle", SCAN_INT16, angle_of);
	add(cloud, "point_source_id", SCAN_UINT16, byte_of);
}

/* ------------------------------------------------------------------------------------- tests */

/* How many points a file's format byte and LASzip record say there are, and of which kind. */
static void says(unsigned format_number, laz_compressor kind, size_t count)
{
	size_t length;
	uint8_t *file = load(laz_path, &length);
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
				add(&cloud, "nir", SCAN_UINT16, byte_of);
			add_extra(&cloud);
			same_as_las(&cloud);
			says(number, LAZ_LAYERED, 3000);
			scan_clear(&cloud);
		}
}

/* Points that came from an old format keep it. */
static void old_formats(void **state)
{
	(void)state;
	for (unsigned number = 0; number < 4; number++) {
		scan cloud = make_cloud(3000, number & 1);
		add(&cloud, "scan_angle_rank", SCAN_INT8, signed_of);
		if (number & 1)
			add(&cloud, "gps_time", SCAN_FLOAT64, leaping_time);
		if (number & 2)
			add_colors(&cloud);
		add_extra(&cloud);
		same_as_las(&cloud);
		says(number, LAZ_CHUNKED, 3000);
		scan_clear(&cloud);
	}
}

/* The same on one processor as on all. */
static void any_number_of_threads(void **state)
{
	(void)state;
	scan cloud = make_cloud(3 * CHUNK + 1, false);
	size_t length, other_length;
	write_file(&laz_format, laz_path, &cloud);
	uint8_t *all = load(laz_path, &length);
	cpu_set_t before, one;
	assert_int_equal(sched_getaffinity(0, sizeof before, &before), 0);
	CPU_ZERO(&one);
	for (size_t cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
		if (CPU_ISSET(cpu, &before))
			CPU_SET(cpu, &one);
	assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
	write_file(&laz_format, laz_path, &cloud);
	sched_setaffinity(0, sizeof before, &before);
	uint8_t *single = load(laz_path, &other_length);
	assert_int_equal(length, other_length);
	assert_memory_equal(all, single, length);
	free(all);
	free(single);
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
