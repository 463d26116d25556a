/*
 * test_parts.c - points of a file read and written part by part, and those of them that are kept
 * where memory does not hold all.
 */
#include "expected.h"
#include "own_folder.h"
#include "files/output_file.h"
#include "points/scan_thinning.h"
#include "points/scan_told.h"
#include "table/format_parts.h"
#include "table/format_table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define COUNT 20000u

/* Numbers from 0 to 1, the same every time. */
static double random_number(uint64_t *state)
{
	*state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (double)(*state >> 11) * 0x1p-53;
}

static scan_column *add(scan *cloud, const char *name, scan_type type)
{
	gw_error error;
	scan_column *column = scan_add_column(cloud, name, type, &error);
	assert_non_null(column);
	return column;
}

/* A square of 2 m at z = 1, of which half of the points lie within a tenth of its width; its colour
 * is the number of the point. */
static scan uneven_square(void)
{
	scan cloud = { .count = COUNT, .up = 'z' };
	uint64_t state = 1;
	add(&cloud, "x", SCAN_FLOAT64);
	add(&cloud, "y", SCAN_FLOAT64);
	add(&cloud, "z", SCAN_FLOAT32);
	add(&cloud, "number", SCAN_UINT32);
	for (size_t i = 0; i < COUNT; i++) {
		scan_store(scan_find(&cloud, "x"), i, (i % 2 ? 0.2 : 2.0) * random_number(&state));
		scan_store(scan_find(&cloud, "y"), i, 2.0 * random_number(&state));
		scan_store(scan_find(&cloud, "z"), i, 1.0);
		scan_store(scan_find(&cloud, "number"), i, (double)i);
	}
	return cloud;
}

/* A square of 400 by 400 points a centimetre apart, of which 3 by 3 amid it emit a thousand, and
 * all others nothing, or all the same; points without place, or with an emission that cannot be,
 * add none. */
static scan lamp_square(bool even)
{
	static const char *const name[] = { "emission_r", "emission_g", "emission_b" };
	const scan_type type[] = { SCAN_FLOAT32, SCAN_FLOAT64, SCAN_FLOAT32 };
	scan cloud = { .count = (size_t)400 * 400, .up = 'z' };
	add(&cloud, "x", SCAN_FLOAT64);
	add(&cloud, "y", SCAN_FLOAT64);
	add(&cloud, "z", SCAN_FLOAT32);
	for (size_t k = 0; k < 3; k++)
		add(&cloud, name[k], type[k]);
	for (size_t i = 0; i < cloud.count; i++) {
		bool lamp = even || (i % 400 / 3 == 66 && i / 400 / 3 == 66);
		scan_store(scan_find(&cloud, "x"), i, 0.01 * (double)(i % 400));
		scan_store(scan_find(&cloud, "y"), i, 0.01 * (double)(i / 400));
		scan_store(scan_find(&cloud, "z"), i, 1.0);
		for (size_t k = 0; k < 3; k++)
			scan_store(scan_find(&cloud, name[k]), i, lamp ? 1000.0 / (1.0 + (double)k) : 0.0);
	}
	scan_store(scan_find(&cloud, name[1]), 7, -5.0);
	scan_store(scan_find(&cloud, name[2]), 8, NAN);
	scan_store(scan_find(&cloud, "x"), 9, NAN);
	scan_store(scan_find(&cloud, name[0]), 9, 1e6);
	return cloud;
}

/* Rows [first, first + count) of a cloud as a cloud. */
static scan rows_of(const scan *cloud, size_t first, size_t count)
{
	scan part = { .count = count, .up = cloud->up };
	for (size_t c = 0; c < cloud->column_count; c++) {
		const scan_column *from = &cloud->column[c];
		size_t size = scan_type_size(from->type);
		memcpy(add(&part, from->name, from->type)->data, (const char *)from->data + first * size,
			   count * size);
	}
	return part;
}

static scan kept_by(uint32_t threads, const scan *cloud, size_t most, size_t part_points)
{
	gw_error error;
	scan_thinning thinning = scan_thinning_begin(most, threads);
	for (size_t first = 0; first < cloud->count; first += part_points) {
		size_t left = cloud->count - first;
		scan part = rows_of(cloud, first, left < part_points ? left : part_points);
		assert_ok(scan_thinning_add(&thinning, &part, &error), &error);
		scan_clear(&part);
	}
	scan kept;
	scan_thinning_take(&thinning, &kept);
	scan_thinning_clear(&thinning);
	return kept;
}

static scan kept_of(const scan *cloud, size_t most, size_t part_points)
{
	return kept_by(1, cloud, most, part_points);
}

/* No more than there may be and hardly less, each a point of the cloud with all that it has; and
 * evenly: of the dense tenth no more than its share of cubes, which those on its border make larger
 * by one column of the 31 and more that there are. */
static void thinned_evenly(void **state)
{
	(void)state;
	scan cloud = uneven_square(), kept = kept_of(&cloud, 2000, 3000);
	size_t dense = 0;
	assert_in_range(kept.count, 1860, 2000);
	for (size_t k = 0; k < kept.count; k++) {
		size_t i = (size_t)scan_value(scan_find(&kept, "number"), k);
		for (size_t c = 0; c < kept.column_count; c++)
			assert_true(scan_value(&kept.column[c], k) ==
						scan_value(scan_find(&cloud, kept.column[c].name), i));
		dense += scan_value(scan_find(&kept, "x"), k) < 0.2;
	}
	assert_in_range(dense, kept.count / 13, kept.count * 5 / 31);
	scan_clear(&kept);
	scan_clear(&cloud);
}

/* How the cloud is parted is no matter, but for the first cubes, which the first part makes. */
static void parts_are_no_matter(void **state)
{
	(void)state;
	scan cloud = uneven_square();
	scan kept = kept_of(&cloud, 1500, COUNT), again = kept_of(&cloud, 1500, COUNT);
	assert_int_equal(kept.count, again.count);
	for (size_t c = 0; c < kept.column_count; c++)
		assert_memory_equal(kept.column[c].data, again.column[c].data,
							kept.count * scan_type_size(kept.column[c].type));
	scan_clear(&again);
	scan_clear(&kept);
	kept = kept_of(&cloud, COUNT + 1, 777);
	assert_true(kept.count > COUNT * 9 / 10);
	scan_clear(&kept);
	scan_clear(&cloud);
}

/* Threads change nothing: neither where cubes get wider amid a part, nor where most points of a
 * part replace others of it. */
static void threads_are_no_matter(void **state)
{
	(void)state;
	scan cloud = uneven_square();
	for (size_t most = 50; most < COUNT; most *= 6) {
		scan kept = kept_by(1, &cloud, most, 9000), again = kept_by(5, &cloud, most, 9000);
		assert_int_equal(kept.count, again.count);
		for (size_t c = 0; c < kept.column_count; c++)
			assert_memory_equal(kept.column[c].data, again.column[c].data,
								kept.count * scan_type_size(kept.column[c].type));
		scan_clear(&kept);
		scan_clear(&again);
	}
	scan_clear(&cloud);
}

/* Points that are kept stay when they come again. */
static void kept_points_stay(void **state)
{
	(void)state;
	gw_error error;
	scan cloud = uneven_square(), kept, again;
	scan_thinning thinning = scan_thinning_begin(900, 2);
	assert_ok(scan_thinning_add(&thinning, &cloud, &error), &error);
	scan_thinning_take(&thinning, &kept);
	scan_thinning_clear(&thinning);
	thinning = scan_thinning_begin(900, 2);
	assert_ok(scan_thinning_add(&thinning, &cloud, &error), &error);
	size_t count = thinning.kept.count;
	assert_ok(scan_thinning_add(&thinning, &kept, &error), &error);
	assert_int_equal(thinning.kept.count, count);
	scan_thinning_take(&thinning, &again);
	assert_int_equal(again.count, kept.count);
	for (size_t c = 0; c < kept.column_count; c++)
		assert_memory_equal(kept.column[c].data, again.column[c].data,
							kept.count * scan_type_size(kept.column[c].type));
	scan_thinning_clear(&thinning);
	scan_clear(&again);
	scan_clear(&kept);
	scan_clear(&cloud);
}

/* What is kept is from 0.93 to all of what may be, where there are more: of surface as of points
 * that fill space or lie in rows, however many there may be and whenever there was no more room;
 * and of four places on many sides of the origin no more than there are. */
static void as_many_as_may_be(void **state)
{
	(void)state;
	scan square = uneven_square(), rows = lamp_square(true), space = uneven_square();
	uint64_t random = 7;
	for (size_t i = 0; i < COUNT; i++)
		scan_store(scan_find(&space, "z"), i, 2.0 * random_number(&random));
	const scan *const all[] = { &square, &rows, &space };
	for (size_t k = 0; k < 3; k++)
		for (size_t most = 300; most < COUNT * 2 / 3; most = most * 9 / 8) {
			scan kept = kept_by(2, all[k], most, 4000);
			assert_in_range(kept.count, (93 * most + 99) / 100, most);
			scan_clear(&kept);
		}
	for (size_t i = 0; i < COUNT; i++)
		for (int k = 0; k < 2; k++)
			scan_store(scan_find(&square, k ? "y" : "x"), i, i >> k & 1 ? 1e6 : -1e6);
	scan kept = kept_of(&square, 1, 4000);
	assert_in_range(kept.count, 1, 4);
	scan_clear(&kept);
	scan_clear(&square);
	scan_clear(&rows);
	scan_clear(&space);
}

/* Points far off and such as have no place take no room from the others; one place over and over is
 * one point. */
static void far_and_nowhere(void **state)
{
	(void)state;
	scan cloud = uneven_square();
	scan_column *x = scan_find(&cloud, "x");
	scan_store(x, 3, NAN);
	scan_store(x, 4, INFINITY);
	scan_store(x, 5, -1e300);
	scan kept = kept_of(&cloud, 2000, 3000);
	assert_in_range(kept.count, 1860, 2000);
	for (size_t k = 0; k < kept.count; k++)
		assert_true(isfinite(scan_value(scan_find(&kept, "x"), k)));
	scan_clear(&kept);
	for (size_t i = 0; i < COUNT; i++) {
		scan_store(x, i, 7.0);
		scan_store(scan_find(&cloud, "y"), i, 7.0);
	}
	kept = kept_of(&cloud, 2000, 3000);
	assert_int_equal(kept.count, 1);
	scan_clear(&kept);
	scan_clear(&cloud);
}

/* Both sheets of a wall thinner than a cube are kept where normals tell them apart. */
static void sheets_are_kept(void **state)
{
	(void)state;
	scan cloud = uneven_square();
	scan_column *normal = NULL;
	for (int k = 0; k < 3; k++)
		normal = add(&cloud, (const char *const[]){ "nx", "ny", "nz" }[k], SCAN_FLOAT32);
	for (size_t i = 0; i < COUNT; i++)
		scan_store(normal, i, i / 2 % 2 ? 1.0 : -1.0);
	scan kept = kept_of(&cloud, 2000, 3000);
	size_t up = 0;
	for (size_t k = 0; k < kept.count; k++)
		up += scan_value(scan_find(&kept, "nz"), k) > 0.0;
	/* One of every cube that is full faces each way: halves but for cubes with few points. */
	assert_in_range(up, kept.count * 4 / 10, kept.count * 6 / 10);
	scan_clear(&kept);
	scan_clear(&cloud);
}

static double sum_of(const scan *cloud, const char *column)
{
	double sum = 0.0;
	for (size_t i = 0; i < cloud->count; i++)
		sum += scan_value(scan_find(cloud, column), i);
	return sum;
}

/* Kept of a cloud by one thread and by three, which emit the same: the power of one of the columns
 * as a share of that of all nine points of the lamp. */
static double power_kept(const scan *lamp, size_t most, int column)
{
	static const char *const name[] = { "emission_r", "emission_g", "emission_b" };
	scan kept = kept_by(1, lamp, most, 9000), again = kept_by(3, lamp, most, 9000);
	double stands_for = (double)lamp->count / (double)kept.count;
	assert_true(stands_for >= 100.0);
	for (int k = 0; k < 3; k++)
		assert_true(sum_of(&again, name[k]) == sum_of(&kept, name[k]));
	/* Along each side lie as many cubes as fit and on the average one more, cut off at both ends:
	 * those of the lamp are larger than the mean one. */
	double cut = 1.0 - 1.0 / sqrt((double)kept.count);
	double all = 9000.0 / (1.0 + column) * cut * cut;
	double power = sum_of(&kept, name[column]) * stands_for / all;
	scan_clear(&again);
	scan_clear(&kept);
	return power;
}

/* What emits keeps its power, however few points are kept, by parts and threads as they come: the
 * lamp is smaller than a cube of 100 points and more, so that its points count 9 among as many as
 * there are in its cubes. Into those go whole cubes of before, from a half to twice as many as on
 * the average along each side, so that only of many numbers of points is the mean power that of the
 * lamp: of 43 whose power differs by a half, by a twelfth, here twice that. */
static void emission_is_that_of_all(void **state)
{
	(void)state;
	scan lamp = lamp_square(false), even = lamp_square(true);
	double sum = 0.0, tries = 0.0;
	for (size_t most = 200; most <= 1600; most = most * 21 / 20, tries++) {
		double power = power_kept(&lamp, most, (int)(most % 3));
		assert_true(power > 0.25 && power < 4.0);
		sum += power;
	}
	assert_true(fabs(sum / tries - 1.0) < 1.0 / 6.0);
	for (size_t most = 200; most <= 1600; most *= 2) {
		scan kept = kept_of(&even, most, 5000);
		for (size_t i = 0; i < kept.count; i++)
			assert_true(scan_value(scan_find(&kept, "emission_r"), i) == 1000.0);
		scan_clear(&kept);
	}
	scan_clear(&even);
	scan_clear(&lamp);
}

static void columns_must_agree(void **state)
{
	(void)state;
	gw_error error;
	scan cloud = uneven_square(), other = rows_of(&cloud, 0, 10);
	scan_thinning thinning = scan_thinning_begin(100, 1);
	assert_ok(scan_thinning_add(&thinning, &cloud, &error), &error);
	scan_remove_column(&other, "number");
	assert_int_equal(scan_thinning_add(&thinning, &other, &error), GW_ERROR_DATA);
	scan_remove_column(&other, "z");
	assert_int_equal(scan_thinning_add(&thinning, &other, &error), GW_ERROR_DATA);
	scan_thinning_clear(&thinning);
	scan_clear(&other);
	scan_clear(&cloud);
}

static void write_as(const char *name, const char *path, const scan *cloud)
{
	gw_error error;
	output_file *out;
	assert_ok(output_file_create(&out, path, true, &error), &error);
	assert_ok(format_by_name(name)->write(out, cloud, &error), &error);
	assert_ok(output_file_commit(&out, &error), &error);
}

static void write_whole(const char *path, const scan *cloud)
{
	write_as("ply", path, cloud);
}

static void write_parts(const char *path, const scan *cloud, size_t part_points)
{
	gw_error error;
	output_file *out;
	const format *ply = format_by_name("ply");
	const format_whole all = { .count = cloud->count };
	assert_ok(output_file_create(&out, path, true, &error), &error);
	for (size_t first = 0; first < cloud->count; first += part_points) {
		size_t left = cloud->count - first;
		scan part = rows_of(cloud, first, left < part_points ? left : part_points);
		if (first == 0)
			assert_ok(ply->parted->write_head(out, &all, &part, &error), &error);
		assert_ok(ply->parted->write_rows(out, &all, &part, &error), &error);
		scan_clear(&part);
	}
	assert_ok(output_file_commit(&out, &error), &error);
}

static void assert_same_rows(const scan *part, const scan *cloud, size_t first)
{
	assert_int_equal(part->column_count, cloud->column_count);
	for (size_t c = 0; c < part->column_count; c++) {
		size_t size = scan_type_size(part->column[c].type);
		assert_string_equal(part->column[c].name, cloud->column[c].name);
		assert_memory_equal(part->column[c].data,
							(const char *)cloud->column[c].data + first * size, part->count * size);
	}
}

/* Files that parts are written to are those that are written at once; read in any parts, more than
 * once, they have the same points. */
static void files_in_parts(void **state)
{
	(void)state;
	gw_error error;
	const format_options options = { .threads = 2 };
	scan cloud = uneven_square(), read;
	format_parts parts;
	write_parts("parts.ply", &cloud, 1234);
	write_whole("whole.ply", &cloud);
	assert_ok(format_read("parts.ply", NULL, &read, &error), &error);
	assert_int_equal(read.count, COUNT);
	assert_same_rows(&read, &cloud, 0);
	scan_clear(&read);
	assert_ok(format_parts_open("whole.ply", &options, &parts, &error), &error);
	assert_non_null(parts.found);
	assert_int_equal(parts.count, COUNT);
	for (int times = 0; times < 2; times++)
		for (size_t first = 0; first < COUNT; first += 4567) {
			assert_ok(format_parts_read(&parts, first, 4567, &read, &error), &error);
			assert_int_equal(read.count, COUNT - first < 4567 ? COUNT - first : 4567);
			assert_same_rows(&read, &cloud, first);
			scan_clear(&read);
		}
	format_parts_close(&parts);
	scan_clear(&cloud);
	unlink("parts.ply");
	unlink("whole.ply");
}

/* Of a LAS file parts have all columns, until it is known which of them hold nothing. */
static void las_in_parts(void **state)
{
	(void)state;
	gw_error error;
	const format_options options = { .threads = 2 };
	scan cloud = uneven_square(), whole, kept;
	format_parts parts;
	write_as("las", "whole.las", &cloud);
	assert_ok(format_read("whole.las", NULL, &whole, &error), &error);
	assert_ok(format_parts_open("whole.las", &options, &parts, &error), &error);
	assert_int_equal(parts.count, COUNT);
	assert_int_equal(parts.together, 1);
	for (size_t first = 0; first < COUNT; first += 4567) {
		assert_ok(format_parts_read(&parts, first, 4567, &kept, &error), &error);
		assert_true(kept.column_count > whole.column_count);
		if (first + 4567 < COUNT)
			scan_clear(&kept);
	}
	assert_ok(format_parts_settle(&parts, &kept, &error), &error);
	assert_int_equal(kept.column_count, whole.column_count);
	assert_ok(format_parts_follow(&parts, &kept, &error), &error);
	scan_clear(&kept);
	for (size_t first = 0; first < COUNT; first += 4567) {
		assert_ok(format_parts_read(&parts, first, 4567, &kept, &error), &error);
		assert_int_equal(kept.column_count, whole.column_count);
		assert_same_rows(&kept, &whole, first);
		scan_clear(&kept);
	}
	format_parts_close(&parts);
	scan_clear(&whole);
	scan_clear(&cloud);
	unlink("whole.las");
}

static void write_text(const char *path, const char *head, size_t bytes)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	fputs(head, file);
	for (size_t i = 0; i < bytes; i++)
		fputc(1, file);
	assert_int_equal(fclose(file), 0);
}

/* What cannot be read in parts is left to those that read it at once, who say what is wrong. */
static void files_not_in_parts(void **state)
{
	(void)state;
#define XYZ "property float x\nproperty float y\nproperty float z\n"
	static const struct {
		const char *head;
		size_t bytes;
		uint64_t count;
	} file[] = {
		{ "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" XYZ "end_header\n", 36, 3 },
		{ "ply\nformat binary_big_endian 1.0\nelement vertex 3\n" XYZ "end_header\n", 36, 3 },
		{ "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" XYZ "end_header\n", 35, 0 },
		{ "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" XYZ "end_header\n", 48, 0 },
		{ "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "end_header\n1 2 3\n", 0, 0 },
		{ "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" XYZ
		  "property list uchar int k\nend_header\n",
		  60, 0 },
		{ "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty int a\n"
		  "element vertex 3\n" XYZ "end_header\n",
		  40, 0 },
		{ "1 2 3\n4 5 6\n", 0, 0 },
	};
	gw_error error;
	const format_options options = { .threads = 1 };
	for (size_t i = 0; i < sizeof file / sizeof *file; i++) {
		format_parts parts;
		write_text("parts.txt", file[i].head, file[i].bytes);
		assert_ok(format_parts_open("parts.txt", &options, &parts, &error), &error);
		assert_int_equal(parts.count, file[i].count);
		assert_true((parts.found != NULL) == (file[i].count > 0));
		format_parts_close(&parts);
	}
	unlink("parts.txt");
}

/* What the values of all points tell holds for a part whose values would tell something else. */
static void told_by_all(void **state)
{
	(void)state;
	gw_error error;
	scan cloud = { .count = 1000, .up = 'z' };
	static const char *const name[] = { "x", "y", "z", "red", "green", "blue", "opacity" };
	for (size_t c = 0; c < 7; c++) {
		scan_column *column = add(&cloud, name[c], c < 3 ? SCAN_FLOAT32 : SCAN_UINT16);
		for (size_t i = 0; i < cloud.count; i++)
			scan_store(column, i, c < 3 ? (double)i : c < 6 ? 65.0 * (double)i : (double)(i / 2));
	}
	scan_told told;
	assert_ok(scan_told_find(&cloud, &told, &error), &error);
	scan part = rows_of(&cloud, 0, 3);
	scan_points_options options = SCAN_POINTS_OPTIONS_DEFAULT;
	options.linear_colors = true;
	options.told = &told;
	scan_points points;
	assert_ok(scan_points_make(&part, &options, &points, &error), &error);
	/* Colours of 16 bits, as single precision holds them; opacities of the same. */
	assert_true(fabs((double)points.albedo[6] - 130.0 / 65535.0) <= 0x1p-24);
	assert_non_null(points.opacity);
	assert_true(fabs((double)points.opacity[2] - 1.0 / 65535.0) <= 0x1p-24);
	scan_points_clear(&points);
	options.told = NULL;
	assert_ok(scan_points_make(&part, &options, &points, &error), &error);
	assert_true((double)points.albedo[6] > 0.5);
	scan_points_clear(&points);
	scan_clear(&part);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(thinned_evenly),        cmocka_unit_test(parts_are_no_matter),
		cmocka_unit_test(threads_are_no_matter), cmocka_unit_test(kept_points_stay),
		cmocka_unit_test(as_many_as_may_be),     cmocka_unit_test(far_and_nowhere),
		cmocka_unit_test(sheets_are_kept),       cmocka_unit_test(emission_is_that_of_all),
		cmocka_unit_test(columns_must_agree),    cmocka_unit_test(files_in_parts),
		cmocka_unit_test(las_in_parts),          cmocka_unit_test(files_not_in_parts),
		cmocka_unit_test(told_by_all),
	};
	return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
