#include "laz_clouds.h"
#include "one_processor.h"
#include "table/format_table.h"

#include <math.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ------------------------------------------------------------------------------------ clouds */

double hashed(size_t i, uint64_t salt)
{
	uint64_t h = (i + 1) * 0x9e3779b97f4a7c15u + salt * 0xbf58476d1ce4e5b9u;
	h = (h ^ h >> 29) * 0x94d049bb133111ebu;
	return (double)(h >> 11) * 0x1p-53;
}

void add_values(scan *cloud, const char *name, scan_type type, cloud_value *value)
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

scan make_cloud(size_t count, bool wild)
{
	scan cloud = { .count = count };
	add_values(&cloud, "x", SCAN_FLOAT64, wild ? wild_x : floor_x);
	add_values(&cloud, "y", SCAN_FLOAT64, wild ? wild_y : floor_y);
	add_values(&cloud, "z", SCAN_FLOAT64, wild ? wild_z : floor_z);
	add_values(&cloud, "intensity", SCAN_UINT16, byte_of);
	return cloud;
}

void add_colors(scan *cloud)
{
	add_values(cloud, "red", SCAN_UINT8, color_of);
	add_values(cloud, "green", SCAN_UINT8, color_of);
	add_values(cloud, "blue", SCAN_UINT8, byte_of);
}

void add_extra(scan *cloud)
{
	static const char *const names[SCAN_TYPE_COUNT] = { "a", "b", "c", "d", "e", "f", "g", "h" };
	for (size_t t = 0; t < SCAN_TYPE_COUNT; t++)
		add_values(cloud, names[t], (scan_type)t, t < SCAN_FLOAT32 ? number_of : real_of);
	add_values(cloud, "constant", SCAN_INT16, angle_of);
	add_values(cloud, "signed", SCAN_INT8, signed_of);
}

void add_pulses(scan *cloud, bool wild)
{
	add_values(cloud, "gps_time", SCAN_FLOAT64, wild ? leaping_time : steady_time);
	add_values(cloud, "return_number", SCAN_UINT8, number_of);
	add_values(cloud, "number_of_returns", SCAN_UINT8, returns_of);
	add_values(cloud, "scanner_channel", SCAN_UINT8, channel_of);
	add_values(cloud, "overlap", SCAN_UINT8, flag_of);
	add_values(cloud, "edge_of_flight_line", SCAN_UINT8, flag_of);
	add_values(cloud, "classification", SCAN_UINT8, byte_of);
	add_values(cloud, "user_data", SCAN_UINT8, byte_of);
	add_values(cloud, "scan_angle", SCAN_INT16, angle_of);
	add_values(cloud, "point_source_id", SCAN_UINT16, byte_of);
}

void add_infrared(scan *cloud)
{
	add_values(cloud, "nir", SCAN_UINT16, byte_of);
}

void add_rank(scan *cloud)
{
	add_values(cloud, "scan_angle_rank", SCAN_INT8, signed_of);
}

/* ------------------------------------------------------------------------------------- files */

void write_cloud(const format *f, const char *path, const scan *cloud)
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

scan read_cloud(const char *path)
{
	scan cloud;
	gw_error error = { 0 };
	if (format_read(path, NULL, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return cloud;
}

uint8_t *load_bytes(const char *path, size_t *length)
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

void same_by_one_processor(const format *f, const char *path, const scan *cloud)
{
	size_t length, other_length;
	write_cloud(f, path, cloud);
	uint8_t *all = load_bytes(path, &length);
	cpu_set_t before;
	keep_to_one_processor(&before);
	write_cloud(f, path, cloud);
	sched_setaffinity(0, sizeof before, &before);
	uint8_t *single = load_bytes(path, &other_length);
	assert_int_equal(length, other_length);
	assert_memory_equal(all, single, length);
	free(all);
	free(single);
}
