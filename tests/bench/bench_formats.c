/*
 * bench_formats.c - how fast each format is read and written: points and megabytes a second.
 *
 *   bench_formats [POINTS [FILE...]]
 *
 * Without files: a cloud of so many points (500000) with normals, colours and intensity is written
 * as every format that can be, into the current folder, read with one and with two threads, and
 * removed. With files: those are read.
 */
#include "format.h"
#include "output_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static double seconds(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static uint64_t state = 1;

/* In [0, 1), in steps of 2^-20. */
static double next(void)
{
	state = state * 6364136223846793005u + 1442695040888963407u;
	return (double)(state >> 44) * 0x1p-20;
}

/* A rough sphere, in millimetres. */
static gw_status make_cloud(size_t count, scan *cloud, gw_error *error)
{
	static const struct {
		const char *name;
		scan_type type;
	} columns[] = {
		{ "x", SCAN_FLOAT64 },        { "y", SCAN_FLOAT64 },   { "z", SCAN_FLOAT64 },
		{ "nx", SCAN_FLOAT32 },       { "ny", SCAN_FLOAT32 },  { "nz", SCAN_FLOAT32 },
		{ "red", SCAN_UINT8 },        { "green", SCAN_UINT8 }, { "blue", SCAN_UINT8 },
		{ "intensity", SCAN_UINT16 },
	};
	*cloud = (scan){ .count = count, .up = 'z' };
	for (size_t c = 0; c < sizeof columns / sizeof *columns; c++)
		if (!scan_add_column(cloud, columns[c].name, columns[c].type, error))
			return GW_ERROR_MEMORY;
	for (size_t i = 0; i < count; i++) {
		double z = 2.0 * next() - 1.0, a = 6.28318530718 * next(), r = sqrt(1.0 - z * z);
		const double n[3] = { r * cos(a), r * sin(a), z };
		for (size_t k = 0; k < 3; k++) {
			double at = round(1e4 * n[k] * (1.0 + 0.01 * next())) / 1e3;
			scan_store(&cloud->column[k], i, at);
			scan_store(&cloud->column[3 + k], i, n[k]);
			scan_store(&cloud->column[6 + k], i, floor(255.0 * next()));
		}
		scan_store(&cloud->column[9], i, floor(65535.0 * next()));
	}
	return GW_OK;
}

static void print(const char *what, const char *name, size_t points, double bytes, double took)
{
	printf("%-6s %-8s %7.2f million points/s %8.1f MB/s\n", name, what,
		   1e-6 * (double)points / took, 1e-6 * bytes / took);
}

static gw_status read_twice(const char *path, const char *name, gw_error *error)
{
	struct stat info;
	gw_status status = GW_OK;
	if (stat(path, &info) != 0)
		return gw_fail(error, GW_ERROR_NO_INPUT, "%s is not there", path);
	for (uint32_t threads = 1; threads <= 2 && status == GW_OK; threads++) {
		format_options options = { .name = name, .threads = threads };
		const format *found;
		scan cloud;
		double start = seconds();
		status = format_read_with(path, &options, &cloud, &found, error);
		double took = seconds() - start;
		if (status == GW_OK)
			print(threads == 1 ? "read 1" : "read 2", found->name, cloud.count,
				  (double)info.st_size, took);
		scan_clear(&cloud);
	}
	return status;
}

static gw_status write_once(const format *f, const scan *cloud, const char *path, gw_error *error)
{
	output_file *out;
	struct stat info;
	double start = seconds();
	gw_status status = output_file_create(&out, path, true, error);
	if (status == GW_OK)
		status = f->write(out, cloud, error);
	if (status == GW_OK)
		status = output_file_commit(&out, error);
	double took = seconds() - start;
	output_file_abandon(&out);
	if (status == GW_OK && stat(path, &info) == 0)
		print("write", f->name, cloud->count, (double)info.st_size, took);
	return status;
}

static gw_status all_formats(size_t count, gw_error *error)
{
	scan cloud;
	gw_status status = make_cloud(count, &cloud, error);
	for (size_t f = 0; formats[f] && status == GW_OK; f++) {
		char path[64];
		snprintf(path, sizeof path, "bench_formats.%d.%s", (int)getpid(), formats[f]->name);
		if (!formats[f]->write)
			continue;
		status = write_once(formats[f], &cloud, path, error);
		if (status == GW_OK && formats[f]->read)
			status = read_twice(path, formats[f]->name, error);
		unlink(path);
	}
	scan_clear(&cloud);
	return status;
}

int main(int count, char **arguments)
{
	gw_error error = { 0 };
	gw_status status = GW_OK;
	size_t points = count > 1 ? strtoul(arguments[1], NULL, 10) : 500000;
	if (count <= 2)
		status = all_formats(points, &error);
	for (int i = 2; i < count && status == GW_OK; i++)
		status = read_twice(arguments[i], NULL, &error);
	if (status != GW_OK)
		fprintf(stderr, "bench_formats: %s\n", error.text);
	return status != GW_OK;
}
