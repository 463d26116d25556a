/* Formats: tables of text (XYZ, CSV, PTS, PTX) and PCD, in and out. */
#include "table/format_table.h"
#include "pcd/pcd_format.h"
#include "text/text_formats.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

typedef gw_status (*reader)(input_file *, scan *, gw_error *);

/* ------------------------------------------------------------------------------- helpers */

/* Reads from memory of exactly the length, so that a sanitizer sees a byte too many. */
static gw_status read_with(reader read, const void *data, size_t length, const char *columns,
						   scan *cloud, gw_error *error)
{
	uint8_t *copy = malloc(length + !length);
	memcpy(copy, data, length);
	input_file in = {
		.name = "test.file", .data = copy, .length = length, .columns = columns, .threads = 2
	};
	gw_status status = read(&in, cloud, error);
	free(copy);
	return status;
}

static scan read_text(reader read, const char *text, const char *columns)
{
	scan cloud;
	gw_error error = { 0 };
	if (read_with(read, text, strlen(text), columns, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return cloud;
}

/* The reader must refuse and say all of the words. */
static void assert_refused(reader read, const char *text, const char *columns, const char *word)
{
	scan cloud;
	gw_error error = { 0 };
	gw_status status = read_with(read, text, strlen(text), columns, &cloud, &error);
	if (status == GW_OK || !strstr(error.text, word))
		fail_msg("status %d, '%s' does not say '%s'", status, error.text, word);
	assert_null(cloud.column);
}

static void assert_names(const scan *cloud, const char *expected)
{
	char names[512] = "";
	for (size_t c = 0; c < cloud->column_count; c++)
		strcat(strcat(names, c ? " " : ""), cloud->column[c].name);
	assert_string_equal(names, expected);
}

static void assert_value(const scan *cloud, const char *name, size_t i, double expected)
{
	const scan_column *column = scan_find(cloud, name);
	if (!column)
		fail_msg("no column '%s'", name);
	double value = scan_value(column, i);
	if (value != expected && !(isnan(value) && isnan(expected)))
		fail_msg("%s of point %zu is %.17g, not %.17g", name, i, value, expected);
}

static void assert_type(const scan *cloud, const char *name, scan_type type)
{
	const scan_column *column = scan_find(cloud, name);
	assert_non_null(column);
	assert_int_equal(column->type, type);
}

/* ----------------------------------------------------------------------------- XYZ and CSV */

static void names_come_from_the_values(void **state)
{
	(void)state;
	static const struct {
		const char *text, *names;
	} tables[] = {
		{ "1 2 3\n4 5 6\n", "x y z" },
		{ "1 2 3 25\n4 5 6 30", "x y z intensity" },
		{ "1 2 3 255 0 17\n4 5 6 1 2 3\n", "x y z red green blue" },
		{ "1 2 3 0.5 0 1\n4 5 6 1 0.25 0\n", "x y z red green blue" },
		{ "1 2 3 0 0 1\n4 5 6 0.6 0.8 0\n", "x y z nx ny nz" },
		{ "1 2 3 0 0 -0.5\n4 5 6 0.6 0.1 0\n", "x y z nx ny nz" },
		{ "1 2 3 255 0 17 0.5\n", "x y z red green blue field_7" },
		{ "1 2 3 -99 255 0 17\n", "x y z intensity red green blue" },
		/* Colours are written alike, and so this is no red. */
		{ "1 2 3 0.0 10 119 55\n4 5 6 0.0 9 118 5\n", "x y z intensity red green blue" },
		{ "1 2 3 37.0 10 119 55\n", "x y z intensity red green blue" },
		{ "1 2 3 1.0 10.0 119.0 55\n", "x y z red green blue field_7" },
		{ "1 2 3 9 8 7 0 0 -1\n", "x y z red green blue nx ny nz" },
		{ "1 2 3 0 0 -1 9 8 7\n", "x y z nx ny nz red green blue" },
		{ "1;2;3;-7.5;400;9\n", "x y z field_4 field_5 field_6" },
		{ "# a comment\n\n// one more\n1,2,3\n", "x y z" },
	};
	for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
		scan cloud = read_text(xyz_read, tables[t].text, NULL);
		assert_names(&cloud, tables[t].names);
		assert_value(&cloud, "z", 0, 3.0);
		scan_clear(&cloud);
	}
}

static void names_come_from_a_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *names;
	} tables[] = {
		{ "X,Y,Z,Intensity\r\n1,2,3,4\r\n", "x y z intensity" },
		{ "\"X\",\"Y\",\"Z\",\"My own\"\n1,2,3,4\n", "x y z My own" },
		{ "//X Y Z R G B Nx Ny Nz\n1 2 3 4 5 6 7 8 9\n", "x y z red green blue nx ny nz" },
		{ "# scanned by hand\n# z y x\n3 2 1\n", "z y x" },
		{ "x; y; z\n1; 2; 3\n", "x y z" },
		{ "\xef\xbb\xbfx,y,z\n1,2,3\n", "x y z" },
		{ "x\ty\tz\r1\t2\t3\r", "x y z" },
		{ "label,x,y,z\n1,1,2,3\n", "label x y z" },
		{ "# one two three\n1 2 3\n", "x y z" },
	};
	for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
		scan cloud = read_text(xyz_read, tables[t].text, NULL);
		assert_names(&cloud, tables[t].names);
		assert_int_equal(cloud.count, 1);
		assert_value(&cloud, "x", 0, 1.0);
		assert_value(&cloud, "z", 0, 3.0);
		scan_clear(&cloud);
	}
}

static void names_come_from_the_user(void **state)
{
	(void)state;
	scan cloud = read_text(xyz_read, "a wall 3 0.5 1 2\n", "-,-,z,i,x,y");
	assert_names(&cloud, "z intensity x y");
	assert_value(&cloud, "x", 0, 1.0);
	scan_clear(&cloud);
	/* A first line without a number where x stands is one of names; more values are left out. */
	cloud = read_text(xyz_read, "u,v,w,t\n1,2,3,4\n5,6,7,8\n", "x,y,z");
	assert_names(&cloud, "x y z");
	assert_int_equal(cloud.count, 2);
	scan_clear(&cloud);
	assert_refused(xyz_read, "1 2 3\n", "x,y", "x, y and z");
	assert_refused(xyz_read, "1 2 3 4\n", "x,y,z,x", "two columns are called 'x'");
}

static void columns_get_the_smallest_type(void **state)
{
	(void)state;
	scan cloud = read_text(xyz_read,
						   "x,y,z,a,b,c,d,e,f,g,h,k\n"
						   "1,2,3,255,-128,65535,-32768,4294967295,-1,0.5,0.1234567,1.0\n"
						   "1,2,3,0,127,0,0,0,-2147483648,-1e10,3,-0\n",
						   NULL);
	static const scan_type types[] = { SCAN_UINT8,   SCAN_INT8,    SCAN_UINT16,
									   SCAN_INT16,   SCAN_UINT32,  SCAN_INT32,
									   SCAN_FLOAT32, SCAN_FLOAT64, SCAN_FLOAT32 };
	for (size_t k = 0; k < 3; k++)
		assert_int_equal(cloud.column[k].type, SCAN_FLOAT64);
	for (size_t k = 0; k < 9; k++)
		assert_int_equal(cloud.column[3 + k].type, types[k]);
	assert_value(&cloud, "b", 0, -128.0);
	assert_value(&cloud, "e", 0, 4294967295.0);
	assert_value(&cloud, "f", 1, -2147483648.0);
	assert_value(&cloud, "h", 0, 0.1234567);
	assert_true(signbit(scan_value(scan_find(&cloud, "k"), 1)));
	scan_clear(&cloud);
}

static void missing_values_are_nan(void **state)
{
	(void)state;
	scan cloud = read_text(xyz_read, "x,y,z,a,b\n1,2,3,,5\n1,,3,4,\n", NULL);
	assert_value(&cloud, "a", 0, NAN);
	assert_value(&cloud, "a", 1, 4.0);
	assert_value(&cloud, "y", 1, NAN);
	assert_value(&cloud, "b", 1, NAN);
	scan_clear(&cloud);
}

static void rows_that_do_not_fit(void **state)
{
	(void)state;
	scan cloud = read_text(xyz_read, "x y z\n1 2 3 4\n\n1 2 3\n", NULL);
	assert_int_equal(cloud.count, 1);
	assert_int_equal(cloud.left_out, 1);
	scan_clear(&cloud);
	assert_refused(xyz_read, "1 2 3\n4 5\n", NULL, "line 2 has 2 values");
	assert_refused(xyz_read, "1 2 3\n\n4 5 6 7\n", NULL, "line 3 has more than 3 values");
	assert_refused(xyz_read, "1 2 3\n4 5 six\n", NULL, "line 2: 'six' as 'z'");
	assert_refused(xyz_read, "1,2,3\n4,5 6,7\n", NULL, "test.file, line 2");
	assert_refused(xyz_read, "1,5;2,5;3,5\n", NULL, "--columns");
	assert_refused(xyz_read, "x;y;z\n1,5;2,5;3,5\n", NULL,
				   "line 2: ',5' as 'x' follows a decimal comma");
	assert_refused(xyz_read, "x,y,x\n1,2,3\n", NULL, "line 1 is neither");
	assert_refused(xyz_read, "x,y,z\n", NULL, "no points");
	assert_refused(xyz_read, "# nothing\n\n", NULL, "no points");
	assert_refused(xyz_read, "1 2\n", NULL, "--columns");
}

/* Several megabytes, so that rows are shared among threads at places that no line ends at. */
static void long_tables_are_read_in_order(void **state)
{
	(void)state;
	enum { ROWS = 150000 };
	char *text = malloc((size_t)ROWS * 48), *at = text;
	for (int i = 0; i < ROWS; i++)
		at += sprintf(at, "%d.125 %d %.*f %d\n", i, -i, i % 9, i / 8.0, i % 251);
	scan cloud;
	gw_error error = { 0 };
	size_t length = (size_t)(at - text);
	assert_true(length > (size_t)3 << 20);
	assert_int_equal(read_with(xyz_read, text, length, "x,y,z,a", &cloud, &error), GW_OK);
	assert_int_equal(cloud.count, ROWS);
	for (size_t i = 0; i < ROWS; i++) {
		char z[32];
		snprintf(z, sizeof z, "%.*f", (int)(i % 9), (double)i / 8.0);
		assert_value(&cloud, "x", i, (double)i + 0.125);
		assert_value(&cloud, "y", i, -(double)i);
		assert_value(&cloud, "z", i, strtod(z, NULL));
		assert_value(&cloud, "a", i, (double)(i % 251));
	}
	scan_clear(&cloud);
	/* Two faults in different stretches: the first one is told, on its line. */
	char *fault = strstr(text, "\n60000.125");
	char *later = strstr(text, "\n140000.125");
	fault[1] = later[1] = 'q';
	assert_int_equal(read_with(xyz_read, text, length, "x,y,z,a", &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "line 60001:"));
	free(text);
}

/* ----------------------------------------------------------------------------- PTS and PTX */

static void pts_with_counts_and_without(void **state)
{
	(void)state;
	static const char *const texts[] = { "1 2 3 -7 10 20 30\n4 5 6 8 40 50 60\n",
										 "2\n1 2 3 -7 10 20 30\n4 5 6 8 40 50 60\n",
										 "1\r\n1 2 3 -7 10 20 30\r\n1\r\n4 5 6 8 40 50 60\r\n" };
	for (size_t t = 0; t < 3; t++) {
		scan cloud = read_text(pts_read, texts[t], NULL);
		assert_names(&cloud, "x y z intensity red green blue");
		assert_int_equal(cloud.count, 2);
		assert_value(&cloud, "intensity", 0, -7.0);
		assert_value(&cloud, "blue", 1, 60.0);
		assert_type(&cloud, "red", SCAN_UINT8);
		scan_clear(&cloud);
	}
	assert_refused(pts_read, "3\n1 2 3\n4 5 6\n", NULL, "count 3 points, but 2 follow");
	assert_refused(pts_read, "1\n1 2 3\n4 5 6\n", NULL, "count 1 points, but 2 follow");
	assert_refused(pts_read, "0.5\n1 2 3\n", NULL, "no count");
	assert_refused(pts_read, "3\n", NULL, "no points");
}

#define AXES "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define IDENTITY "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"

static void ptx_of_two_grids(void **state)
{
	(void)state;
	/* The second turns x to y and moves by 1000, 2000, 3000. */
	scan cloud = read_text(ptx_read,
						   "2\n2\n" AXES IDENTITY "1 2 3 0.5\n0 0 0 0.5\n-0.0 0e1 +0.00 0\n"
						   "4 5 6 0.25\n"
						   "1\n2\n" AXES "0 1 0 0\n-1 0 0 0\n0 0 1 0\n1000 2000 3000 1\n"
						   "1 2 3 0.75 10 20 30\n0 0 0.001 1 40 50 60\n",
						   NULL);
	assert_names(&cloud, "x y z intensity red green blue");
	assert_int_equal(cloud.count, 4);
	assert_int_equal(cloud.left_out, 2);
	assert_value(&cloud, "x", 1, 4.0);
	assert_value(&cloud, "x", 2, 1000.0 - 2.0);
	assert_value(&cloud, "y", 2, 2000.0 + 1.0);
	assert_value(&cloud, "z", 2, 3003.0);
	assert_value(&cloud, "z", 3, 3000.001);
	assert_value(&cloud, "red", 0, 0.0);
	assert_value(&cloud, "red", 3, 40.0);
	assert_type(&cloud, "red", SCAN_UINT8);
	assert_type(&cloud, "intensity", SCAN_FLOAT32);
	static const double scanners[6] = { 0, 0, 0, 1000, 2000, 3000 };
	static const uint32_t seen_by[4] = { 0, 0, 1, 1 };
	assert_int_equal(cloud.scanner_count, 2);
	assert_memory_equal(cloud.scanner, scanners, sizeof scanners);
	assert_memory_equal(cloud.scanner_of, seen_by, sizeof seen_by);
	/* Cells come column after column; the first grid's second and third are empty. */
	static const uint32_t cells[4] = { 0, 3, 0, 1 };
	assert_int_equal(cloud.image_count, 2);
	assert_memory_equal(cloud.image_cell, cells, sizeof cells);
	assert_int_equal(cloud.image[1].first, 2);
	assert_int_equal(cloud.image[1].columns, 1);
	assert_memory_equal(cloud.image[1].scanner, &scanners[3], sizeof cloud.image[1].scanner);
	scan_clear(&cloud);
}

static void ptx_that_is_damaged(void **state)
{
	(void)state;
	assert_refused(ptx_read, "2\n1\n" AXES IDENTITY "1 2 3 0.5\n", NULL, "scan 1 has 2 x 1 cells");
	assert_refused(ptx_read, "4000000000\n4000000000\n" AXES IDENTITY "1 2 3 0.5\n", NULL,
				   "scan 1 has");
	assert_refused(ptx_read, "1\n1\n" AXES "1 0 0 0\n0 1 0 0\n0 0 1 0\n", NULL, "scan 1");
	assert_refused(ptx_read, "1\n1\n" AXES "1 0 0 0\n0 nan 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0\n", NULL,
				   "line 8");
	assert_refused(ptx_read, "1\n1\n" AXES "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0\n", NULL,
				   "matrix");
	assert_refused(ptx_read, "1\n1\n" AXES IDENTITY "1 2 3 0.5\n1\n1\n", NULL, "scan 2");
	assert_refused(ptx_read, "1\n1\n" AXES IDENTITY "1 2\n", NULL, "line 11");
	assert_refused(ptx_read, "1\n-1\n" AXES IDENTITY, NULL, "line 2");
}

/* ----------------------------------------------------------------------------------- PCD */

#define PCD_HEAD                                                                                   \
	"# .PCD v0.7 - Point Cloud Data file format\n# by hand\nVERSION 0.7\n"                         \
	"FIELDS x y z rgb normal_x a b _ h\nSIZE 4 4 8 4 4 1 2 2 4\nTYPE F F F F F I U U F\n"          \
	"COUNT 1 1 1 1 1 1 1 3 2\nWIDTH 1\nHEIGHT 2\n"

static void check_pcd(const scan *cloud)
{
	assert_names(cloud, "x y z red green blue nx a b h_0 h_1");
	assert_int_equal(cloud->count, 2);
	assert_int_equal(cloud->comment_count, 1);
	assert_string_equal(cloud->comment[0], "by hand");
	assert_type(cloud, "z", SCAN_FLOAT64);
	assert_type(cloud, "a", SCAN_INT8);
	assert_value(cloud, "x", 0, 1.5);
	assert_value(cloud, "y", 1, NAN);
	assert_value(cloud, "z", 1, 5400000.123);
	assert_value(cloud, "red", 0, 0x4a);
	assert_value(cloud, "green", 0, 0x80);
	assert_value(cloud, "blue", 0, 0x81);
	assert_value(cloud, "nx", 1, -1.0);
	assert_value(cloud, "a", 0, -128.0);
	assert_value(cloud, "b", 1, 65535.0);
	assert_value(cloud, "h_1", 0, 0.25);
	assert_int_equal(cloud->scanner_count, 1);
	assert_true(cloud->scanner[2] == 9.0);
}

static void pcd_of_text(void **state)
{
	(void)state;
	/* 0x004a8081 as a float is a denormal one. */
	scan cloud = read_text(pcd_read,
						   PCD_HEAD "VIEWPOINT 7 8 9 1 0 0 0\nPOINTS 2\nDATA ascii\n"
									"1.5 2 3 6.8419252e-39 0 -128 0 1 2 3 0.5 0.25\n"
									"4 nan 5400000.123 0 -1 127 65535 1 2 3 1 2\n",
						   NULL);
	check_pcd(&cloud);
	scan_clear(&cloud);
	assert_refused(pcd_read, PCD_HEAD "POINTS 1\nDATA ascii\n1 2 3 0 0 -129 0 1 2 3 0.5 0.25\n",
				   NULL, "'-129' as 'a'");
	assert_refused(pcd_read, PCD_HEAD "POINTS 2\nDATA ascii\n1 2 3 0 0 0 0 1 2 3 0.5 0.25\n", NULL,
				   "test.file");
	assert_refused(pcd_read, "1 2 3\n", NULL, "line 1");
	assert_refused(pcd_read, "VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 0\nDATA ascii\n",
				   NULL, "'z'");
	assert_refused(pcd_read, PCD_HEAD "POINTS 2\n", NULL, "DATA");
	assert_refused(pcd_read, "FIELDS x y z\nSIZE 4 4 3\n", NULL, "line 2: '3'");
	assert_refused(pcd_read, "FIELDS x y z\nSIZE 4 4\n", NULL, "line 2");
	assert_refused(pcd_read, "FIELDS x y z\nSIZE 4 4 2\nTYPE F F F\nPOINTS 0\nDATA binary\n", NULL,
				   "'z'");
}

typedef struct bytes {
	uint8_t data[4096];
	size_t length;
} bytes;

static void put(bytes *b, const void *data, size_t length)
{
	memcpy(b->data + b->length, data, length);
	b->length += length;
}

static void put_text(bytes *b, const char *text)
{
	put(b, text, strlen(text));
}

/* A depth camera's picture of a wall 2 m away, 10 by 10 pixels, in its own frame; `flip` turns it
 * about z, so that its rows begin at the bottom. */
static scan read_camera_picture(bool flip)
{
	char text[8192] = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 10\nHEIGHT 10\n"
					  "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 100\nDATA ascii\n";
	double way = flip ? -0.1 : 0.1;
	for (int i = 0; i < 100; i++) {
		size_t used = strlen(text);
		if (i == 37)
			snprintf(text + used, sizeof text - used, "nan nan nan\n");
		else
			snprintf(text + used, sizeof text - used, "%g %g %g\n", way * (i % 10 - 4.5),
					 way * (i / 10 - 4.5), 2.0 + 0.01 * (i % 3));
	}
	return read_text(pcd_read, text, NULL);
}

/* Rows and columns of a wavy sheet, even in x and y: no rays of one place. */
static scan read_height_map(const char *viewpoint)
{
	char text[16384] = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 20\nHEIGHT 20\n"
					   "VIEWPOINT ";
	size_t used = strlen(text);
	used += (size_t)snprintf(text + used, sizeof text - used, "%s\nPOINTS 400\nDATA ascii\n",
							 viewpoint);
	for (int i = 0; i < 400; i++)
		used += (size_t)snprintf(text + used, sizeof text - used, "%g %g %g\n", 0.1 * (i % 20) - 1,
								 0.1 * (i / 20) - 1, 0.2 * sin(i % 20) * cos(0.7 * (i / 20)));
	return read_text(pcd_read, text, NULL);
}

/* A VIEWPOINT that is the default is no scanner's where rows and columns deny it; any other is. */
static void pcd_of_no_camera(void **state)
{
	(void)state;
	scan cloud = read_height_map("0 0 0 1 0 0 0");
	assert_int_equal(cloud.scanner_count, 0);
	assert_int_equal(cloud.comment_count, 1);
	assert_non_null(strstr(cloud.comment[0], "do not tell where the scanner stood"));
	scan_clear(&cloud);
	cloud = read_height_map("0 0 1 1 0 0 0");
	assert_int_equal(cloud.scanner_count, 1);
	assert_int_equal(cloud.comment_count, 0);
	scan_clear(&cloud);
}

/* In the frame of a depth camera y points down, which the reader finds out and says. */
static void pcd_of_depth_camera(void **state)
{
	(void)state;
	scan cloud = read_camera_picture(false);
	assert_int_equal(cloud.up, 'Y');
	assert_int_equal(cloud.comment_count, 1);
	assert_non_null(strstr(cloud.comment[0], "-y points up"));
	scan_clear(&cloud);
	cloud = read_camera_picture(true);
	assert_int_equal(cloud.up, 'z');
	assert_int_equal(cloud.comment_count, 0);
	scan_clear(&cloud);
}

/* The two points of check_pcd, value by value; this machine is little-endian as the file is. */
static const struct {
	float x, y;
	double z;
	uint32_t rgb;
	float nx;
	int8_t a;
	uint16_t b, gap[3];
	float h[2];
} point[2] = { { 1.5f, 2, 3, 0x4a8081, 0, -128, 0, { 1, 2, 3 }, { 0.5f, 0.25f } },
			   { 4, NAN, 5400000.123, 0, -1, 127, 65535, { 1, 2, 3 }, { 1, 2 } } };

static void put_field(bytes *b, int field, size_t i)
{
	const struct {
		const void *from;
		size_t size;
	} of[] = { { &point[i].x, 4 },   { &point[i].y, 4 },  { &point[i].z, 8 },
			   { &point[i].rgb, 4 }, { &point[i].nx, 4 }, { &point[i].a, 1 },
			   { &point[i].b, 2 },   { point[i].gap, 6 }, { point[i].h, 8 } };
	put(b, of[field].from, of[field].size);
}

enum { PCD_FIELDS = 9, PCD_STRIDE = 41 };

static void pcd_of_bytes(void **state)
{
	(void)state;
	bytes file = { 0 };
	scan cloud;
	gw_error error = { 0 };
	put_text(&file, PCD_HEAD "VIEWPOINT 7 8 9 1 0 0 0\nPOINTS 2\nDATA binary\n");
	for (size_t i = 0; i < 2; i++)
		for (int f = 0; f < PCD_FIELDS; f++)
			put_field(&file, f, i);
	if (read_with(pcd_read, file.data, file.length, NULL, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	check_pcd(&cloud);
	scan_clear(&cloud);
	for (size_t cut = 1; cut <= 2 * PCD_STRIDE; cut++)
		assert_int_equal(read_with(pcd_read, file.data, file.length - cut, NULL, &cloud, &error),
						 GW_ERROR_DATA);
	memset(file.data + file.length, 0, PCD_STRIDE);
	/* What is behind the points is left out and said. */
	if (read_with(pcd_read, file.data, file.length + PCD_STRIDE, NULL, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_int_equal(cloud.count, 2);
	assert_non_null(strstr(cloud.comment[cloud.comment_count - 1], "left out"));
	scan_clear(&cloud);
}

/* Packs into literals of up to 32 bytes, and every byte that is like the two before it into a step
 * back, so that what is repeated overlaps. */
static void pack(bytes *to, const uint8_t *from, size_t length)
{
	for (size_t i = 0; i < length;) {
		size_t run = 0;
		while (i > 0 && i + run < length && run < 200 && from[i + run] == from[i - 1])
			run++;
		if (run >= 3) {
			uint8_t step[3] = { (uint8_t)((run - 2 < 7 ? run - 2 : 7) << 5), 0, 0 };
			if (run - 2 >= 7)
				step[1] = (uint8_t)(run - 2 - 7);
			put(to, step, run - 2 >= 7 ? 3 : 2);
			i += run;
			continue;
		}
		put(to, (uint8_t[]){ 0 }, 1);
		put(to, from + i++, 1);
	}
}

static void pcd_of_packed_bytes(void **state)
{
	(void)state;
	bytes plain = { 0 }, packed = { 0 }, file = { 0 };
	scan cloud;
	gw_error error = { 0 };
	for (int f = 0; f < PCD_FIELDS; f++)
		for (size_t i = 0; i < 2; i++)
			put_field(&plain, f, i);
	pack(&packed, plain.data, plain.length);
	put_text(&file, PCD_HEAD "VIEWPOINT 7 8 9 1 0 0 0\nPOINTS 2\nDATA binary_compressed\n");
	uint32_t sizes[2] = { (uint32_t)packed.length, (uint32_t)plain.length };
	size_t body = file.length;
	put(&file, sizes, sizeof sizes);
	put(&file, packed.data, packed.length);
	if (read_with(pcd_read, file.data, file.length, NULL, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	check_pcd(&cloud);
	scan_clear(&cloud);
	for (size_t cut = 1; cut < file.length - body; cut++)
		assert_int_equal(read_with(pcd_read, file.data, file.length - cut, NULL, &cloud, &error),
						 GW_ERROR_DATA);
	for (size_t at = body; at < body + 8; at++) {
		file.data[at]++;
		assert_int_equal(read_with(pcd_read, file.data, file.length, NULL, &cloud, &error),
						 GW_ERROR_DATA);
		file.data[at]--;
	}
}

/* ----------------------------------------------------------------------------- round trips */

static uint64_t next_random(void)
{
	static uint64_t r = 88172645463325252u;
	r ^= r << 13;
	r ^= r >> 7;
	r ^= r << 17;
	return r;
}

enum { POINTS = 5000 };

/* A scan of every type: coordinates of any double or few digits, colours, a normal, integers up to
 * their limits. */
static scan make_scan(void)
{
	static const struct {
		const char *name;
		scan_type type;
	} columns[] = { { "x", SCAN_FLOAT64 },   { "y", SCAN_FLOAT64 },  { "z", SCAN_FLOAT64 },
					{ "nx", SCAN_FLOAT32 },  { "a", SCAN_FLOAT64 },  { "red", SCAN_UINT8 },
					{ "green", SCAN_UINT8 }, { "blue", SCAN_UINT8 }, { "alpha", SCAN_UINT8 },
					{ "i8", SCAN_INT8 },     { "i16", SCAN_INT16 },  { "u16", SCAN_UINT16 },
					{ "i32", SCAN_INT32 },   { "u32", SCAN_UINT32 }, { "f", SCAN_FLOAT32 } };
	scan cloud = { .count = POINTS, .up = 'z' };
	for (size_t c = 0; c < sizeof columns / sizeof *columns; c++) {
		scan_column *to = scan_add_column(&cloud, columns[c].name, columns[c].type, NULL);
		uint8_t *random = to->data;
		for (size_t b = 0; b < POINTS * scan_type_size(to->type); b++)
			random[b] = (uint8_t)(next_random() >> 32);
		for (size_t i = 0; i < POINTS; i++) {
			if (c < 3 && i % 3)
				((double *)to->data)[i] = (double)(next_random() >> 24) / (i % 3 == 1 ? 1e3 : 1e7);
			/* The sign and the bits of a NaN are not printed. */
			if (to->type == SCAN_FLOAT64 && isnan(((double *)to->data)[i]))
				((double *)to->data)[i] = NAN;
			if (to->type == SCAN_FLOAT32 && isnan(((float *)to->data)[i]))
				((float *)to->data)[i] = NAN;
		}
	}
	scan_add_comment(&cloud, "made of random bits", NULL);
	return cloud;
}

static scan write_and_read(const scan *cloud, const char *name)
{
	char path[] = "/tmp/glowworm-test-XXXXXX";
	gw_error error = { 0 };
	output_file *out;
	scan back;
	close(mkstemp(path));
	const format *format_of = format_by_name(name);
	if (output_file_create(&out, path, true, &error) != GW_OK ||
		format_of->write(out, cloud, &error) != GW_OK ||
		output_file_commit(&out, &error) != GW_OK ||
		format_read(path, name, &back, &error) != GW_OK)
		fail_msg("%s", error.text);
	unlink(path);
	return back;
}

static void assert_same(const scan *a, const scan *b, const char *name, bool bits)
{
	const scan_column *one = scan_find(a, name), *other = scan_find(b, name);
	assert_non_null(other);
	if (bits) {
		assert_int_equal(one->type, other->type);
		assert_memory_equal(one->data, other->data, a->count * scan_type_size(one->type));
		return;
	}
	for (size_t i = 0; i < a->count; i++) {
		double v = scan_value(one, i), w = scan_value(other, i);
		if (one->type == SCAN_FLOAT32)
			w = (double)(float)w;
		if (v != w && !(isnan(v) && isnan(w)))
			fail_msg("%s of point %zu was %.17g and came back as %.17g", name, i, v, w);
	}
}

static void every_number_comes_back(void **state)
{
	(void)state;
	static const char *const names[] = { "pcd", "xyz", "csv", "ply" };
	scan cloud = make_scan();
	for (size_t n = 0; n < 4; n++) {
		scan back = write_and_read(&cloud, names[n]);
		bool text = n == 1 || n == 2;
		assert_int_equal(back.count, POINTS);
		assert_int_equal(back.column_count, cloud.column_count);
		assert_int_equal(back.comment_count, n != 2); /* CSV has no comments */
		for (size_t c = 0; c < cloud.column_count; c++)
			assert_same(&cloud, &back, cloud.column[c].name, !text || c < 3);
		scan_clear(&back);
	}
	scan_clear(&cloud);
}

/* PCL reads no doubles: what floats hold is written as floats. */
static void pcd_has_floats_where_they_do(void **state)
{
	(void)state;
	scan cloud = { .count = 2, .up = 'z' };
	for (int k = 0; k < 3; k++) {
		scan_column *to =
			scan_add_column(&cloud, (const char *[]){ "x", "y", "z" }[k], SCAN_FLOAT64, NULL);
		memcpy(to->data, (double[]){ 1.5, k == 1 ? NAN : -4e6 }, 16);
	}
	scan back = write_and_read(&cloud, "pcd");
	assert_type(&back, "x", SCAN_FLOAT32);
	assert_value(&back, "z", 1, -4e6);
	scan_clear(&back);
	((double *)scan_find(&cloud, "z")->data)[1] = 0.1;
	back = write_and_read(&cloud, "pcd");
	assert_type(&back, "x", SCAN_FLOAT64);
	assert_value(&back, "z", 1, 0.1);
	scan_clear(&back);
	scan_clear(&cloud);
}

static void no_points_come_back(void **state)
{
	(void)state;
	scan cloud = { .up = 'z' };
	for (int k = 0; k < 3; k++)
		scan_add_column(&cloud, (const char *[]){ "x", "y", "z" }[k], SCAN_FLOAT64, NULL);
	scan back = write_and_read(&cloud, "pcd");
	assert_int_equal(back.count, 0);
	assert_names(&back, "x y z");
	scan_clear(&back);
	scan_clear(&cloud);
}

static void names_cannot_be_injected(void **state)
{
	(void)state;
	scan cloud = { .count = 1, .up = 'z' };
	static const char *const names[] = { "x", "y", "z", "a b\n1 2 3", "c,d;e\"f", "" };
	for (int k = 0; k < 6; k++)
		scan_add_column(&cloud, names[k], SCAN_FLOAT64, NULL);
	scan_add_comment(&cloud, "a\n9 9 9 9 9 9\nDATA binary", NULL);
	static const char *const formats_out[] = { "pcd", "xyz", "csv" };
	for (size_t n = 0; n < 3; n++) {
		scan back = write_and_read(&cloud, formats_out[n]);
		assert_int_equal(back.count, 1);
		assert_int_equal(back.column_count, 6);
		assert_value(&back, "x", 0, 0.0);
		scan_clear(&back);
	}
	scan_clear(&cloud);
}

/* ----------------------------------------------------------------------------- recognition */

static void content_tells_the_format(void **state)
{
	(void)state;
	static const struct {
		const char *text, *name;
	} files[] = { { "1 2 3\n", "xyz" },       { "# hello\nx,y,z\n1,2,3\n", "xyz" },
				  { "1\n1 2 3\n", "pts" },    { "1\n1\n" AXES IDENTITY "1 2 3 0.5\n", "ptx" },
				  { PCD_HEAD, "pcd" },        { "VERSION .7\n", "pcd" },
				  { "OFF\n8 6 12\n", "off" }, { "solid cube\n", NULL },
				  { "<html>\n", NULL } };
	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		const char *found = NULL;
		for (size_t f = 0; formats[f] && !found; f++)
			if (formats[f]->probe &&
				formats[f]->probe((const uint8_t *)files[i].text, strlen(files[i].text)))
				found = formats[f]->name;
		if (files[i].name)
			assert_string_equal(found, files[i].name);
		else
			assert_null(found);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(names_come_from_the_values),
		cmocka_unit_test(names_come_from_a_line),
		cmocka_unit_test(names_come_from_the_user),
		cmocka_unit_test(columns_get_the_smallest_type),
		cmocka_unit_test(missing_values_are_nan),
		cmocka_unit_test(rows_that_do_not_fit),
		cmocka_unit_test(long_tables_are_read_in_order),
		cmocka_unit_test(pts_with_counts_and_without),
		cmocka_unit_test(ptx_of_two_grids),
		cmocka_unit_test(ptx_that_is_damaged),
		cmocka_unit_test(pcd_of_text),
		cmocka_unit_test(pcd_of_depth_camera),
		cmocka_unit_test(pcd_of_no_camera),
		cmocka_unit_test(pcd_of_bytes),
		cmocka_unit_test(pcd_of_packed_bytes),
		cmocka_unit_test(every_number_comes_back),
		cmocka_unit_test(pcd_has_floats_where_they_do),
		cmocka_unit_test(no_points_come_back),
		cmocka_unit_test(names_cannot_be_injected),
		cmocka_unit_test(content_tells_the_format),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
