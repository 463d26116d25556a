/* E57: a file made by hand, whole and damaged; clouds that are written and read again. */
#include "e57_file.h"
#include "e57/e57_format.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static uint8_t content[E57_FILE_ROOM], file[E57_FILE_PAGES(E57_FILE_ROOM)];
static size_t content_length, xml;

static int make_content(void **state)
{
	(void)state;
	content_length = e57_file_content(content, &xml);
	return content_length <= sizeof content ? 0 : -1;
}

/* Reads the content in pages, from memory of exactly their length. */
static gw_status read_content(const uint8_t *bytes, size_t length, scan *cloud, gw_error *error)
{
	size_t size = e57_file_pages(bytes, length, xml, file);
	uint8_t *copy = malloc(size + !size);
	memcpy(copy, file, size);
	input_file in = { .name = "test.e57", .data = copy, .length = size, .threads = 2 };
	gw_status status = e57_read(&in, cloud, error);
	free(copy);
	return status;
}

static double value_at(const scan *cloud, const char *name, size_t i)
{
	const scan_column *column = scan_find(cloud, name);
	if (!column)
		fail_msg("no column '%s'", name);
	return scan_value(column, i);
}

static void scans_are_joined(void **state)
{
	(void)state;
	scan cloud;
	gw_error error = { 0 };
	if (read_content(content, content_length, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_int_equal(cloud.count, 6);
	assert_int_equal(cloud.left_out, 1);
	assert_int_equal(cloud.column_count, 7);
	static const int record[4] = { 0, 1, 3, 4 };
	for (size_t i = 0; i < 4; i++) {
		/* Raw values are record * 250, scaled and shifted; then x turns to y. */
		double x = record[i] * 250 * 0.001 + 5, y = record[i] + 0.5, z = -record[i] / 8.0;
		assert_true(value_at(&cloud, "x", i) == -y + 1000);
		assert_true(value_at(&cloud, "y", i) == x + 2000);
		assert_true(value_at(&cloud, "z", i) == z + 3000);
		assert_true(value_at(&cloud, "intensity", i) == 7);
		assert_true(value_at(&cloud, "red", i) == record[i] * 50 + 4);
		assert_true(value_at(&cloud, "blue", i) == record[i] * 50 + 6);
	}
	/* The second scan: range 2 along x, and range 4 at 1.5 and -0.5 radians. */
	assert_true(value_at(&cloud, "x", 4) == 2 && value_at(&cloud, "y", 4) == 0);
	assert_true(value_at(&cloud, "x", 5) == 4 * cos(-0.5) * cos(1.5));
	assert_true(value_at(&cloud, "y", 5) == 4 * cos(-0.5) * sin(1.5));
	assert_true(value_at(&cloud, "z", 5) == 4 * sin(-0.5));
	assert_true(value_at(&cloud, "red", 5) == 0);
	assert_int_equal(scan_find(&cloud, "red")->type, SCAN_UINT8);
	assert_int_equal(scan_find(&cloud, "x")->type, SCAN_FLOAT64);
	static const double scanners[6] = { 1000, 2000, 3000, 0, 0, 0 };
	static const uint32_t seen_by[6] = { 0, 0, 0, 0, 1, 1 };
	assert_int_equal(cloud.scanner_count, 2);
	assert_memory_equal(cloud.scanner, scanners, sizeof scanners);
	assert_memory_equal(cloud.scanner_of, seen_by, sizeof seen_by);
	scan_clear(&cloud);
}

/* Every bit of every page is under a checksum. */
static void damaged_pages_are_refused(void **state)
{
	(void)state;
	size_t size = e57_file_pages(content, content_length, xml, file);
	for (size_t bit = 0; bit < 8 * size; bit += 7) {
		scan cloud;
		gw_error error = { 0 };
		input_file in = { .name = "test.e57", .data = file, .length = size, .threads = 1 };
		file[bit / 8] ^= (uint8_t)(1 << bit % 8);
		assert_int_equal(e57_read(&in, &cloud, &error), GW_ERROR_DATA);
		assert_non_null(strstr(error.text, "test.e57"));
		file[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
}

/* Replaces a word of the description by one of the same length. */
static void assert_refused(const char *word, const char *lie, const char *message)
{
	uint8_t damaged[E57_FILE_ROOM];
	scan cloud;
	gw_error error = { 0 };
	memcpy(damaged, content, sizeof damaged);
	uint8_t *place = memmem(damaged + xml, content_length - xml, word, strlen(word));
	assert_non_null(place);
	assert_int_equal(strlen(word), strlen(lie));
	memcpy(place, lie, strlen(lie));
	gw_status status = read_content(damaged, content_length, &cloud, &error);
	if (status == GW_OK || !strstr(error.text, message))
		fail_msg("'%s' gives %d, '%s'", lie, status, error.text);
}

/* Names that mean something in the first line of a table do not here. */
static void fields_keep_their_names(void **state)
{
	(void)state;
	uint8_t changed[E57_FILE_ROOM];
	scan cloud;
	gw_error error = { 0 };
	memcpy(changed, content, sizeof changed);
	uint8_t *place = memmem(changed + xml, content_length - xml, "intensity", 9);
	memcpy(place, "elevation", 9);
	if (read_content(changed, content_length, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_true(value_at(&cloud, "elevation", 0) == 7);
	scan_clear(&cloud);
}

static void descriptions_that_lie_are_refused(void **state)
{
	(void)state;
	assert_refused("recordCount=\"5\"", "recordCount=\"9\"", "scan 1 has 9 records");
	assert_refused("recordCount=\"2\"", "recordCount=\"3\"", "scan 2 has 3 records");
	assert_refused("recordCount=\"5\"", "recordCount=\"x\"", "CompressedVector");
	assert_refused("fileOffset=\"48\"", "fileOffset=\"49\"", "scan 1");
	assert_refused("fileOffset=\"48\"", "fileOffset=\"-8\"", "CompressedVector");
	assert_refused("maximum=\"1000\"", "maximum=\"-999\"", "minimum, maximum");
	assert_refused("scale=\"0.001\"", "scale=\"infty\"", "scale");
	assert_refused("<cartesianZ ", "<cartesianW ", "scan 1 have neither");
	assert_refused("> 1e0 </z>", "> inf </z>", "pose");
	assert_refused("\"Float\">1000</x>", "\"Float\">1e99x/x>", "XML");
	assert_refused("<y type=\"Float\">2000", "<y type=\"Float\">nano", "pose");
	assert_refused("</data3D>", "</data3E>", "XML");
	assert_refused("?>\n<e57Root type=\"Structure\">", "?><!DOCTYPE e57Root><e57Root>", "declared");
}

/* ------------------------------------------------------------------------------- written */

/* Writes a cloud and reads it again. */
static void write_and_read(const scan *cloud, scan *again)
{
	char folder[] = "/tmp/glowworm-test-XXXXXX", path[sizeof folder + 16];
	gw_error error = { 0 };
	output_file *out;
	input_file in;
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/cloud.e57", folder);
	if (output_file_create(&out, path, false, &error) != GW_OK ||
		e57_write(out, cloud, &error) != GW_OK || output_file_commit(&out, &error) != GW_OK ||
		input_file_open(&in, path, &error) != GW_OK || e57_read(&in, again, &error) != GW_OK)
		fail_msg("%s", error.text);
	input_file_close(&in);
	unlink(path);
	rmdir(folder);
}

static scan_column *add_column(scan *cloud, const char *name, scan_type type)
{
	gw_error error = { 0 };
	scan_column *column = scan_add_column(cloud, name, type, &error);
	assert_non_null(column);
	return column;
}

/* A cloud with coordinates that no short number is. */
static void make_cloud(scan *cloud, size_t count, scan_type type)
{
	static const char *const name[3] = { "x", "y", "z" };
	*cloud = (scan){ .count = count, .up = 'z' };
	for (size_t k = 0; k < 3; k++) {
		scan_column *column = add_column(cloud, name[k], type);
		for (size_t i = 0; i < count; i++)
			scan_store(column, i, (double)(float)(sin((double)(7 * i + k)) * 123.4));
	}
}

/* All columns of one are in the other, with the same values; coordinates but for `rounding`.
 *   order   NULL, or point i of the other */
static void assert_same(const scan *cloud, const scan *again, const size_t *order, double rounding)
{
	assert_int_equal(again->count, cloud->count);
	for (size_t c = 0; c < cloud->column_count; c++) {
		const scan_column *column = &cloud->column[c];
		for (size_t i = 0; i < cloud->count; i++) {
			double expected = scan_value(column, order ? order[i] : i);
			double found = value_at(again, column->name, i);
			double most = c < 3 ? rounding : 0.0;
			if (!(found == expected || fabs(found - expected) <= most ||
				  (isnan(found) && isnan(expected))))
				fail_msg("%s of point %zu is %.17g, but was %.17g", column->name, i, found,
						 expected);
		}
	}
}

static void nothing_is_written_and_read(void **state)
{
	(void)state;
	scan cloud, again;
	make_cloud(&cloud, 0, SCAN_FLOAT32);
	write_and_read(&cloud, &again);
	assert_int_equal(again.count, 0);
	scan_clear(&cloud);
	scan_clear(&again);
}

/* More than a packet of points, and of every type the least, the greatest, and what lies between.
 */
static void every_type_is_written_and_read(void **state)
{
	(void)state;
	static const double limit[SCAN_TYPE_COUNT][2] = {
		[SCAN_INT8] = { -128, 127 },
		[SCAN_UINT8] = { 0, 255 },
		[SCAN_INT16] = { -32768, 32767 },
		[SCAN_UINT16] = { 0, 65535 },
		[SCAN_INT32] = { -2147483648.0, 2147483647.0 },
		[SCAN_UINT32] = { 0, 4294967295.0 },
		[SCAN_FLOAT32] = { -3.4028234663852886e38, 1.401298464324817e-45 },
		[SCAN_FLOAT64] = { -1.7976931348623157e308, 5e-324 },
	};
	enum { COUNT = 20011 };
	scan cloud, again;
	make_cloud(&cloud, COUNT, SCAN_FLOAT64);
	for (int type = 0; type < SCAN_TYPE_COUNT; type++) {
		char name[32];
		snprintf(name, sizeof name, "type %d_x41_", type);
		scan_column *column = add_column(&cloud, name, (scan_type)type);
		for (size_t i = 0; i < COUNT; i++)
			scan_store(column, i, i < 2 ? limit[type][i] : (double)(i * 37 % 101));
	}
	scan_store(scan_find(&cloud, "type 6_x41_"), 7, NAN);
	scan_store(scan_find(&cloud, "type 7_x41_"), 8, -INFINITY);
	scan_column *same = add_column(&cloud, "always the same", SCAN_INT16);
	for (size_t i = 0; i < COUNT; i++)
		scan_store(same, i, -5);
	add_column(&cloud, "cartesianX", SCAN_UINT8);
	add_column(&cloud, "intensity", SCAN_UINT16);
	add_column(&cloud, "rowIndex", SCAN_FLOAT32);
	add_column(&cloud, "\xc3\xa9 <&>\n", SCAN_UINT8);
	write_and_read(&cloud, &again);
	assert_int_equal(again.column_count, cloud.column_count);
	assert_same(&cloud, &again, NULL, 0.0);
	assert_int_equal(again.scanner_count, 0);
	scan_clear(&cloud);
	scan_clear(&again);
}

static void comments_are_written_and_read(void **state)
{
	(void)state;
	static const char *const said[] = { "glowworm units: <radiance> & more ]]>", "", "\xc3\xa9",
										SCAN_NOTE "of the input", "a\tb\xff" };
	static const char *const found[] = { "glowworm units: <radiance> & more ]]>", "", "\xc3\xa9",
										 "a b?" };
	gw_error error = { 0 };
	scan cloud, again;
	make_cloud(&cloud, 1, SCAN_FLOAT32);
	for (size_t c = 0; c < sizeof said / sizeof *said; c++)
		assert_int_equal(scan_add_comment(&cloud, said[c], &error), GW_OK);
	write_and_read(&cloud, &again);
	assert_int_equal(again.comment_count, sizeof found / sizeof *found);
	for (size_t c = 0; c < again.comment_count; c++)
		assert_string_equal(again.comment[c], found[c]);
	scan_clear(&cloud);
	scan_clear(&again);
}

/* Points of two scanners by turns, and some of none: three scans, in which they keep their order,
 * and from whose places their coordinates are counted. */
static void scans_are_written_and_read(void **state)
{
	(void)state;
	enum { COUNT = 3000 };
	static const double place[2][3] = { { 12.3, -4.56, 1.7 }, { -100.1, 30, 2 } };
	static size_t order[COUNT];
	gw_error error = { 0 };
	scan cloud, again;
	make_cloud(&cloud, COUNT, SCAN_FLOAT32);
	assert_int_equal(scan_part_scanners(&cloud, &error), GW_OK);
	for (uint32_t s = 0; s < 2; s++)
		assert_int_equal(scan_scanner_at(&cloud, place[s]), s);
	for (size_t i = 0; i < COUNT; i++)
		cloud.scanner_of[i] = i % 3 == 2 ? SCAN_NO_SCANNER : (uint32_t)(i % 3);
	for (size_t i = 0; i < COUNT; i++)
		order[i] = i % (COUNT / 3) * 3 + i / (COUNT / 3);
	write_and_read(&cloud, &again);
	/* Half of the last bit of what is below 256, from where the scanner stood, and again. */
	assert_same(&cloud, &again, order, 0x1p-45);
	assert_int_equal(again.scanner_count, 2);
	assert_memory_equal(again.scanner, place, sizeof place);
	for (size_t i = 0; i < COUNT; i++)
		assert_int_equal(again.scanner_of[i],
						 i / (COUNT / 3) == 2 ? SCAN_NO_SCANNER : i / (COUNT / 3));
	scan_clear(&cloud);
	scan_clear(&again);
}

/* A picture of 20 columns of 10 rows, without every seventh cell, and a point that is not finite.
 */
static void pictures_are_written_and_read(void **state)
{
	(void)state;
	enum { CELLS = 200, COUNT = CELLS - (CELLS + 6) / 7 };
	gw_error error = { 0 };
	scan cloud, again;
	gw_range_image image = { .count = COUNT, .columns = 20, .rows = 10, .scanner = { 1, 2, 3 } };
	make_cloud(&cloud, COUNT, SCAN_FLOAT64);
	assert_int_equal(scan_add_image(&cloud, &image, &error), GW_OK);
	assert_int_equal(scan_add_scanner(&cloud, image.scanner, 0, COUNT, &error), GW_OK);
	for (size_t cell = 0, i = 0; cell < CELLS; cell++)
		if (cell % 7 != 0)
			cloud.image_cell[i++] = (uint32_t)cell;
	scan_store(scan_find(&cloud, "y"), COUNT - 1, NAN);
	write_and_read(&cloud, &again);
	assert_int_equal(again.count, COUNT - 1);
	assert_int_equal(again.left_out, 1);
	assert_int_equal(again.image_count, 1);
	assert_int_equal(again.image[0].columns, 20);
	assert_int_equal(again.image[0].rows, 10);
	assert_memory_equal(again.image_cell, cloud.image_cell, (COUNT - 1) * sizeof(uint32_t));
	assert_memory_equal(again.scanner, image.scanner, sizeof image.scanner);
	scan_clear(&cloud);
	scan_clear(&again);
}

/* A record of 64 bits a column that fills no packet by eight is refused. */
static void too_many_columns_are_refused(void **state)
{
	(void)state;
	gw_error error = { 0 };
	output_file *out;
	scan cloud;
	make_cloud(&cloud, 1, SCAN_FLOAT64);
	for (int c = 0; c < 1100; c++) {
		char name[16];
		snprintf(name, sizeof name, "c%d", c);
		add_column(&cloud, name, SCAN_FLOAT64);
	}
	assert_int_equal(output_file_create(&out, "/dev/null", true, &error), GW_OK);
	assert_int_equal(e57_write(out, &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "1103 columns"));
	output_file_abandon(&out);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scans_are_joined),
		cmocka_unit_test(damaged_pages_are_refused),
		cmocka_unit_test(fields_keep_their_names),
		cmocka_unit_test(descriptions_that_lie_are_refused),
		cmocka_unit_test(nothing_is_written_and_read),
		cmocka_unit_test(every_type_is_written_and_read),
		cmocka_unit_test(comments_are_written_and_read),
		cmocka_unit_test(scans_are_written_and_read),
		cmocka_unit_test(pictures_are_written_and_read),
		cmocka_unit_test(too_many_columns_are_refused),
	};
	return cmocka_run_group_tests(tests, make_content, NULL);
}
