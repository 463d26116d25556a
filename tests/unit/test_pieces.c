/*
 * test_pieces.c - points that are read some at a time, and gathered: of each format, however many
 * come at once, they are those that are read at once, and pieces that differ join as scans do.
 */
#include "expected.h"
#include "own_folder.h"
#include "e57/e57_format.h"
#include "files/output_file.h"
#include "points/scan_color.h"
#include "points/scan_thinning.h"
#include "table/format_pieces.h"
#include "table/format_table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define POINTS 101u

static double coordinate(size_t i, size_t k)
{
	return round(1e4 * sin((double)(7 * i + 3 * k))) / 1e3;
}

/* ------------------------------------------------------------------------------------- files */

static void write_table(const char *path, const char *first, bool counts)
{
	FILE *out = fopen(path, "w");
	assert_non_null(out);
	fprintf(out, "%s", first);
	for (size_t i = 0; i < POINTS; i++) {
		if (counts && i == POINTS / 2)
			fprintf(out, "%zu\n", POINTS - i);
		fprintf(out, "%.3f %.3f %.3f %zu %zu %zu %zu\n", coordinate(i, 0), coordinate(i, 1),
				coordinate(i, 2), 10 * i, i, 2 * i, i / 2);
	}
	assert_int_equal(fclose(out), 0);
}

/* Two grids of 8 columns of 5 cells, some of them empty; the second one moves its points, and its
 * first column is empty. */
static void write_ptx(const char *path)
{
	FILE *out = fopen(path, "w");
	assert_non_null(out);
	for (int g = 0; g < 2; g++) {
		fprintf(out, "8\n5\n%d 2 3\n1 0 0\n0 1 0\n0 0 1\n", g);
		fprintf(out, "1 0 0 0\n0 1 0 0\n0 0 1 0\n%d %d %d 1\n", g, 2 * g, 3 * g);
		for (size_t i = 0; i < 40; i++) {
			bool empty = i % 7 == 3 || (g == 1 && i < 5);
			for (size_t k = 0; k < 3; k++)
				fprintf(out, "%.3f ", empty ? 0.0 : coordinate(i, k));
			fprintf(out, "0.25 %zu 2 3\n", i);
		}
	}
	assert_int_equal(fclose(out), 0);
}

static void write_pcd(const char *path)
{
	FILE *out = fopen(path, "wb");
	assert_non_null(out);
	fprintf(out,
			"VERSION .7\nFIELDS x y z intensity\nSIZE 4 4 4 2\nTYPE F F F U\nCOUNT 1 1 1 1\n"
			"WIDTH %u\nHEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS %u\nDATA binary\n",
			POINTS, POINTS);
	for (size_t i = 0; i < POINTS; i++) {
		const uint16_t intensity = (uint16_t)(3 * i);
		for (size_t k = 0; k < 3; k++) {
			const float value = (float)coordinate(i, k);
			fwrite(&value, sizeof value, 1, out);
		}
		fwrite(&intensity, sizeof intensity, 1, out);
	}
	assert_int_equal(fclose(out), 0);
}

static scan_column *add_column(scan *cloud, const char *name, scan_type type)
{
	gw_error error = { 0 };
	scan_column *column = scan_add_column(cloud, name, type, &error);
	assert_non_null(column);
	return column;
}

/* A cloud of these points, some, and the first, without a place, with a column that counts up from
 * `first`. */
static scan make_cloud(size_t count, const char *name, scan_type type, double first)
{
	static const char *const axis[3] = { "x", "y", "z" };
	scan cloud = { .count = count, .up = 'z' };
	for (size_t k = 0; k < 3; k++) {
		scan_column *column = add_column(&cloud, axis[k], SCAN_FLOAT64);
		for (size_t i = 0; i < count; i++)
			scan_store(column, i, i % 10 == 0 ? NAN : coordinate(i, k));
	}
	scan_column *column = add_column(&cloud, name, type);
	for (size_t i = 0; i < count; i++)
		scan_store(column, i, first + (double)i);
	return cloud;
}

/* As two scanners saw it. */
static void write_e57(const char *path)
{
	static const double place[2][3] = { { 1.0, 2.0, 3.0 }, { -4.0, 0.5, 1.5 } };
	scan cloud = make_cloud(POINTS, "count", SCAN_UINT16, 1000.0);
	gw_error error = { 0 };
	output_file *out;
	assert_ok(scan_add_scanner(&cloud, place[0], 0, 40, &error), &error);
	assert_ok(scan_add_scanner(&cloud, place[1], 40, POINTS - 40, &error), &error);
	assert_ok(output_file_create(&out, path, true, &error), &error);
	assert_ok(e57_write(out, &cloud, &error), &error);
	assert_ok(output_file_commit(&out, &error), &error);
	scan_clear(&cloud);
}

/* ------------------------------------------------------------------------------------ pieces */

static gathered_points *begin(void)
{
	gw_error error = { 0 };
	gathered_points *g;
	assert_ok(gathered_points_begin("./beside", &g, &error), &error);
	assert_ok(gathered_points_next_file(g, &error), &error);
	return g;
}

/* A file's points, gathered by pieces of at most so many, and how many rows had none. */
static scan gather(const char *path, size_t most, uint64_t *left_out)
{
	const format_options options = { .threads = 1 };
	gw_error error = { 0 };
	format_pieces pieces;
	gathered_points *g = begin();
	scan part;
	assert_ok(format_pieces_open(path, &options, &pieces, &error), &error);
	assert_false(pieces.together);
	for (bool more = true; more;) {
		assert_ok(format_pieces_next(&pieces, most, &part, &error), &error);
		assert_true(part.count <= most);
		more = part.count > 0;
		assert_ok(gathered_points_add(g, &part, &error), &error);
		scan_clear(&part);
	}
	gathered_points_settle(g);
	assert_int_equal(gathered_points_of_file(g, 0, left_out), gathered_points_count(g));
	assert_ok(gathered_points_read(g, 0, (size_t)gathered_points_count(g), &part, &error), &error);
	format_pieces_close(&pieces);
	gathered_points_close(&g);
	return part;
}

static double value_at(const scan *cloud, const char *name, size_t i)
{
	const scan_column *column = scan_find(cloud, name);
	if (!column)
		fail_msg("there is no column '%s'", name);
	return scan_value(column, i);
}

static const double *scanner_of(const scan *cloud, size_t i)
{
	size_t s = cloud->scanner_of ? cloud->scanner_of[i] : 0;
	return s < cloud->scanner_count ? cloud->scanner + 3 * s : NULL;
}

/* To the last bit, and seen from the same places. */
static void assert_same(const scan *found, const scan *whole)
{
	assert_int_equal(found->count, whole->count);
	assert_int_equal(found->column_count, whole->column_count);
	assert_int_equal(found->scanner_count, whole->scanner_count);
	for (size_t i = 0; i < whole->count; i++) {
		const double *a = scanner_of(found, i), *b = scanner_of(whole, i);
		for (size_t c = 0; c < whole->column_count; c++) {
			double expected = scan_value(&whole->column[c], i);
			double value = value_at(found, whole->column[c].name, i);
			if (!(value == expected || (isnan(value) && isnan(expected))))
				fail_msg("%s of point %zu is %.17g, not %.17g", whole->column[c].name, i, value,
						 expected);
		}
		assert_int_equal(a != NULL, b != NULL);
		if (a)
			assert_memory_equal(a, b, 3 * sizeof *a);
	}
}

static void pieces_are_the_file(void **state)
{
	static const char *const path[] = { "a.xyz", "a.csv", "a.pts", "a.ptx", "a.pcd", "a.e57" };
	static const size_t most[] = { 1, 7, 64, POINTS };
	(void)state;
	write_table(path[0], "# a comment\n# x y z intensity red green blue\n", false);
	write_table(path[1], "x y z intensity red green blue\n", false);
	write_table(path[2], "50\n", true);
	write_ptx(path[3]);
	write_pcd(path[4]);
	write_e57(path[5]);
	for (size_t f = 0; f < sizeof path / sizeof *path; f++) {
		gw_error error = { 0 };
		scan whole;
		assert_ok(format_read(path[f], NULL, &whole, &error), &error);
		for (size_t m = 0; m < sizeof most / sizeof *most; m++) {
			size_t column = strstr(path[f], "ptx") && most[m] < 5 ? 5 : most[m];
			uint64_t left_out;
			scan found = gather(path[f], column, &left_out);
			assert_same(&found, &whole);
			assert_int_equal(left_out, whole.left_out);
			scan_clear(&found);
		}
		scan_clear(&whole);
		unlink(path[f]);
	}
}

/* ---------------------------------------------------------------------------- pieces that differ
 */

static void add_cloud(gathered_points *g, scan cloud)
{
	gw_error error = { 0 };
	assert_ok(gathered_points_add(g, &cloud, &error), &error);
	scan_clear(&cloud);
}

static void columns_hold_all_values(void **state)
{
	(void)state;
	gw_error error = { 0 };
	scan all;
	gathered_points *g = begin();
	add_cloud(g, make_cloud(10, "class", SCAN_UINT8, 200.0));
	add_cloud(g, make_cloud(10, "class", SCAN_INT16, -5.0));
	add_cloud(g, make_cloud(10, "opacity", SCAN_FLOAT32, -9.0));
	gathered_points_settle(g);
	/* Across the borders of pieces. */
	assert_ok(gathered_points_read(g, 8, 14, &all, &error), &error);
	assert_int_equal(scan_find(&all, "class")->type, SCAN_INT16);
	for (size_t i = 0; i < 14; i++) {
		double expected = i < 2 ? 208.0 + (double)i : i < 12 ? (double)i - 7.0 : 0.0;
		assert_true(value_at(&all, "class", i) == expected);
		/* What has no opacity is opaque. */
		assert_true(value_at(&all, "opacity", i) == (i < 12 ? 1.0 : (double)i - 21.0));
	}
	scan_clear(&all);
	gathered_points_close(&g);
}

/* Red, green and blue alike, from `first` up in so many steps. */
static scan make_colors(scan_type type, double first, double step)
{
	scan cloud = make_cloud(4, "red", type, 0.0);
	add_column(&cloud, "green", type);
	add_column(&cloud, "blue", type);
	for (int k = 0; k < 3; k++)
		for (size_t i = 0; i < 4; i++)
			scan_store(scan_find(&cloud, scan_color_names[k]), i, first + step * (double)i);
	return cloud;
}

static void colours_count_to_one_number(void **state)
{
	(void)state;
	gw_error error = { 0 };
	scan all;
	gathered_points *g = begin();
	add_cloud(g, make_colors(SCAN_UINT8, 0.0, 85.0));
	assert_ok(gathered_points_next_file(g, &error), &error);
	add_cloud(g, make_colors(SCAN_UINT16, 0.0, 21845.0));
	gathered_points_settle(g);
	assert_ok(gathered_points_read(g, 0, 8, &all, &error), &error);
	for (size_t i = 0; i < 8; i++)
		assert_true(value_at(&all, "green", i) == 21845.0 * (double)(i % 4));
	scan_clear(&all);
	gathered_points_close(&g);
}

/* Points that are thinned keep who saw them, through all that moves them. */
static void thinned_points_keep_their_scanners(void **state)
{
	enum { COUNT = 5000, MOST = 300 };
	static const double place[2][3] = { { 1.0, 0.0, 0.0 }, { 2.0, 0.0, 0.0 } };
	(void)state;
	gw_error error = { 0 };
	scan_thinning thinning = scan_thinning_begin(MOST, 1);
	scan kept, cloud = make_cloud(COUNT, "even", SCAN_UINT8, 0.0);
	for (size_t s = 0; s < 2; s++)
		assert_ok(scan_add_scanner(&cloud, place[s], s, 1, &error), &error);
	for (size_t i = 0; i < COUNT; i++) {
		cloud.scanner_of[i] = i % 3 == 0;
		scan_store(scan_find(&cloud, "even"), i, i % 3 == 0);
	}
	assert_ok(scan_thinning_add(&thinning, &cloud, &error), &error);
	scan_thinning_take(&thinning, &kept);
	assert_in_range(kept.count, MOST / 2, MOST);
	for (size_t i = 0; i < kept.count; i++)
		assert_int_equal(kept.scanner_of[i], value_at(&kept, "even", i));
	scan_clear(&cloud);
	scan_clear(&kept);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pieces_are_the_file),
		cmocka_unit_test(columns_hold_all_values),
		cmocka_unit_test(colours_count_to_one_number),
		cmocka_unit_test(thinned_points_keep_their_scanners),
	};
	return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
