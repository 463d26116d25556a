/*
 * test_las_parts.c - LAS, LAZ and E57 that are written part by part: the bytes of a file that is
 * written at once, however points are split, and where only the last of them says how they have to
 * lie.
 */
#include "expected.h"
#include "own_folder.h"
#include "files/output_file.h"
#include "e57/e57_format.h"
#include "las/las_format.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define COUNT 120001u /* two whole chunks of LAZ and a part of one */

static void add(scan *cloud, const char *name, scan_type type, double base, double step,
				size_t period)
{
	gw_error error;
	scan_column *column = scan_add_column(cloud, name, type, &error);
	assert_non_null(column);
	for (size_t i = 0; i < cloud->count; i++)
		scan_store(column, i, base + step * (double)(i % period));
}

static void set_last(scan *cloud, const char *name, double value)
{
	scan_store(scan_find(cloud, name), cloud->count - 1, value);
}

/* Centimetres, as LAS has them. */
static scan on_a_grid(void)
{
	gw_error error;
	scan cloud = { .count = COUNT, .up = 'z' };
	add(&cloud, "x", SCAN_FLOAT64, 0.0, 0.0, 1);
	add(&cloud, "y", SCAN_FLOAT64, 0.0, 0.0, 1);
	add(&cloud, "z", SCAN_FLOAT32, 1.0, 0.5, 300);
	for (size_t i = 0; i < COUNT; i++) {
		scan_store(&cloud.column[0], i, (double)(i % 400) * 0.01 + 600000.0);
		scan_store(&cloud.column[1], i, (double)(i / 400) * 0.01 + 5000000.0);
	}
	assert_ok(scan_add_comment(&cloud, "las scale 0.01 0.01 0.01", &error), &error);
	assert_ok(scan_add_comment(&cloud, "las offset 600000 5000000 0", &error), &error);
	add(&cloud, "intensity", SCAN_UINT16, 5.0, 1.0, 60000);
	add(&cloud, "return_number", SCAN_UINT8, 1.0, 1.0, 3);
	add(&cloud, "number_of_returns", SCAN_UINT8, 3.0, 0.0, 1);
	add(&cloud, "scan_angle_rank", SCAN_INT8, -20.0, 1.0, 40);
	add(&cloud, "red", SCAN_UINT16, 0.0, 1.0, 250);
	add(&cloud, "green", SCAN_UINT16, 0.0, 1.0, 200);
	add(&cloud, "blue", SCAN_UINT16, 0.0, 1.0, 100);
	add(&cloud, "radiance", SCAN_FLOAT32, 0.0, 0.125, 1000);
	return cloud;
}

/* The last points alone: no grid fits, an intensity is none, there is a ninth return, colours count
 * to 65535. */
static scan off_at_the_end(void)
{
	scan cloud = on_a_grid();
	set_last(&cloud, "x", 600000.1234567);
	set_last(&cloud, "y", 4999999.5);
	set_last(&cloud, "return_number", 9.0);
	scan_remove_column(&cloud, "intensity");
	add(&cloud, "intensity", SCAN_FLOAT32, 5.0, 1.0, 60000);
	set_last(&cloud, "intensity", 0.5);
	for (size_t i = COUNT - 3000; i < COUNT; i++)
		scan_store(scan_find(&cloud, "red"), i, 40000.0);
	return cloud;
}

/* Nothing of LAS, and on no grid. */
static scan of_another_kind(void)
{
	scan cloud = { .count = COUNT, .up = 'z' };
	add(&cloud, "x", SCAN_FLOAT32, 0.1234, 0.00317, 50000);
	add(&cloud, "y", SCAN_FLOAT64, -1000.5, 1.0 / 3.0, 70000);
	add(&cloud, "z", SCAN_FLOAT64, 0.0, 0.25, 11);
	add(&cloud, "quality", SCAN_FLOAT32, 0.0, 0.5, 999);
	return cloud;
}

/* What one scanner saw, but for a point without a place, and colours of a preview. */
static scan of_a_scanner(void)
{
	static const double place[3] = { 12.5, -1000.25, 0.1 };
	gw_error error;
	scan cloud = of_another_kind();
	assert_ok(scan_add_scanner(&cloud, place, 0, cloud.count, &error), &error);
	scan_store(&cloud.column[1], COUNT - 5, (double)NAN);
	scan_store(&cloud.column[0], COUNT - 5, -1e6);
	add(&cloud, "red", SCAN_UINT8, 3.0, 1.0, 100);
	add(&cloud, "green", SCAN_UINT8, 3.0, 0.0, 1);
	add(&cloud, "blue", SCAN_UINT8, 0.0, 1.0, 256);
	add(&cloud, "level", SCAN_INT16, -300.0, 1.0, 999);
	assert_ok(scan_add_comment(&cloud, "said & done", &error), &error);
	return cloud;
}

static scan rows_of(const scan *cloud, size_t first, size_t count)
{
	gw_error error;
	scan part;
	uint32_t *row = malloc(count * sizeof *row);
	assert_non_null(row);
	for (size_t i = 0; i < count; i++)
		row[i] = (uint32_t)(first + i);
	assert_ok(scan_take_points(cloud, row, count, &part, &error), &error);
	for (size_t c = 0; c < cloud->comment_count; c++)
		assert_ok(scan_add_comment(&part, cloud->comment[c], &error), &error);
	for (size_t s = 0; s < cloud->scanner_count; s++)
		assert_ok(scan_add_scanner(&part, cloud->scanner + 3 * s, 0, count, &error), &error);
	free(row);
	return part;
}

typedef gw_status part_use(output_file *out, format_whole *whole, const scan *part,
						   const format_parted *to, gw_error *error);

static gw_status use_parts(const scan *cloud, size_t points, output_file *out, format_whole *whole,
						   const format_parted *to, part_use *use)
{
	gw_error error;
	gw_status status = GW_OK;
	for (size_t first = 0; first < cloud->count && status == GW_OK; first += points) {
		size_t left = cloud->count - first;
		scan part = rows_of(cloud, first, left < points ? left : points);
		status = use(out, whole, &part, to, &error);
		scan_clear(&part);
	}
	return status;
}

static gw_status survey(output_file *out, format_whole *whole, const scan *part,
						const format_parted *to, gw_error *error)
{
	(void)out;
	return to->survey_add(whole, part, error);
}

static gw_status write_rows(output_file *out, format_whole *whole, const scan *part,
							const format_parted *to, gw_error *error)
{
	return to->write_rows(out, whole, part, error);
}

static char *read_bytes(const char *path, size_t *length)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	assert_int_equal(fseek(file, 0, SEEK_END), 0);
	*length = (size_t)ftell(file);
	rewind(file);
	char *bytes = malloc(*length + 1);
	assert_non_null(bytes);
	assert_int_equal(fread(bytes, 1, *length, file), *length);
	fclose(file);
	return bytes;
}

/* By way of another file: rows as such, put where they belong. */
static gw_status write_by_rows(output_file *out, format_whole *whole, const scan *part,
							   const format_parted *to, gw_error *error)
{
	format_loose rows = { .count = part->count };
	output_file *loose;
	size_t length;
	GW_TRY(to->row(whole, part, &rows.row, error));
	GW_TRY(output_file_create(&loose, "rows", true, error));
	GW_TRY(to->write_loose(loose, whole, part, error));
	GW_TRY(output_file_commit(&loose, error));
	char *bytes = read_bytes("rows", &length);
	assert_int_equal(length, rows.row * rows.count);
	rows.bytes = (const uint8_t *)bytes;
	gw_status status = to->pack_loose(out, whole, &rows, error);
	free(bytes);
	return status;
}

static void write_parts(const format *to, const scan *cloud, size_t points, uint32_t threads,
						part_use *use)
{
	gw_error error;
	output_file *out;
	format_whole whole = { .name = "parts", .count = cloud->count };
	const format_parted *parted = to->parted;
	assert_ok(parted->survey_begin(&whole, &error), &error);
	for (bool again = true; again;) {
		assert_int_equal(use_parts(cloud, points, NULL, &whole, parted, survey), GW_OK);
		assert_ok(parted->survey_go_on(&whole, &again, &error), &error);
	}
	assert_ok(output_file_create(&out, "parts", true, &error), &error);
	output_file_use_threads(out, threads);
	scan first = rows_of(cloud, 0, 10);
	assert_ok(parted->write_head(out, &whole, &first, &error), &error);
	scan_clear(&first);
	assert_int_equal(use_parts(cloud, points, out, &whole, parted, use), GW_OK);
	if (parted->write_end)
		assert_ok(parted->write_end(out, &whole, &error), &error);
	assert_ok(output_file_commit(&out, &error), &error);
	parted->survey_clear(&whole);
}

static void assert_same_files(void)
{
	size_t length[2];
	char *whole = read_bytes("whole", &length[0]), *parts = read_bytes("parts", &length[1]);
	assert_int_equal(length[0], length[1]);
	assert_memory_equal(whole, parts, length[0]);
	free(whole);
	free(parts);
	unlink("parts");
}

static void check(const format *to, const scan *cloud)
{
	static const size_t points[] = { 7777, 50000, 130000 };
	gw_error error;
	output_file *out;
	assert_ok(output_file_create(&out, "whole", true, &error), &error);
	assert_ok(to->write(out, cloud, &error), &error);
	assert_ok(output_file_commit(&out, &error), &error);
	for (uint32_t k = 0; k < 3; k++) {
		write_parts(to, cloud, points[k], k + 1, write_rows);
		assert_same_files();
	}
	if (to->parted->pack_loose) {
		write_parts(to, cloud, 60000, 2, write_by_rows);
		assert_same_files();
		unlink("rows");
	}
	unlink("whole");
}

static void parts_are_no_matter(void **state)
{
	(void)state;
	scan (*const make[])(void) = { on_a_grid, off_at_the_end, of_another_kind };
	for (size_t k = 0; k < sizeof make / sizeof *make; k++) {
		scan cloud = make[k]();
		check(&las_format, &cloud);
		check(&laz_format, &cloud);
		check(&e57_format, &cloud);
		scan_clear(&cloud);
	}
	scan cloud = of_a_scanner();
	check(&e57_format, &cloud);
	scan_clear(&cloud);
}

/* What LAS cannot hold is known before the first point is written; so is an input that changed. */
static void refused_by_the_survey(void **state)
{
	(void)state;
	static const double last[] = { (double)NAN, 1e9 };
	gw_error error;
	for (size_t k = 0; k < 3; k++) {
		bool again = true;
		scan cloud = on_a_grid();
		format_whole whole = { .name = "far.las", .count = cloud.count + (k == 2) };
		if (k < 2)
			set_last(&cloud, "x", last[k]);
		assert_ok(las_parted.survey_begin(&whole, &error), &error);
		gw_status status = GW_OK;
		while (status == GW_OK && again) {
			status = use_parts(&cloud, 50000, NULL, &whole, &las_parted, survey);
			if (status == GW_OK)
				status = las_parted.survey_go_on(&whole, &again, &error);
		}
		assert_int_equal(status, GW_ERROR_DATA);
		las_parted.survey_clear(&whole);
		scan_clear(&cloud);
	}
}

/* LAZ says before the points what is known after them. */
static void no_pipe_for_parts_of_laz(void **state)
{
	(void)state;
	gw_error error;
	output_file *out;
	bool again;
	scan cloud = of_another_kind();
	format_whole whole = { .name = "/dev/null", .count = cloud.count };
	assert_ok(laz_parted.survey_begin(&whole, &error), &error);
	for (int round = 0; round < 2; round++) {
		assert_ok(laz_parted.survey_add(&whole, &cloud, &error), &error);
		assert_ok(laz_parted.survey_go_on(&whole, &again, &error), &error);
	}
	assert_false(again);
	assert_ok(output_file_create(&out, "/dev/null", true, &error), &error);
	assert_int_equal(laz_parted.write_head(out, &whole, &cloud, &error), GW_ERROR_USAGE);
	assert_non_null(strstr(error.text, "write LAS"));
	output_file_abandon(&out);
	laz_parted.survey_clear(&whole);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(parts_are_no_matter),
		cmocka_unit_test(refused_by_the_survey),
		cmocka_unit_test(no_pipe_for_parts_of_laz),
	};
	return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
