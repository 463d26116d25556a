/* E57: a file made by hand, whole and damaged. */
#include "e57_file.h"
#include "e57/e57_format.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scans_are_joined),
		cmocka_unit_test(damaged_pages_are_refused),
		cmocka_unit_test(fields_keep_their_names),
		cmocka_unit_test(descriptions_that_lie_are_refused),
	};
	return cmocka_run_group_tests(tests, make_content, NULL);
}
