/* Formats: PLY, .cloud, the table of formats, and OpenVDB grids. */
#include "text/cloud_format.h"
#include "table/format_table.h"
#include "ply/ply_format.h"
#include "grids/vdb_grids.h"
#include "grids/voxel_merge.h"

#include <dlfcn.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[64];

static int make_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/glowworm-test-XXXXXX");
	return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
	(void)state;
	return rmdir(folder);
}

static const char *in_folder(const char *name)
{
	static char path[2][160];
	static int turn;
	turn = !turn;
	snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
	return path[turn];
}

/* ------------------------------------------------------------------------------- helpers */

/* Bytes that are put together piece by piece. */
typedef struct bytes {
	uint8_t data[4096];
	size_t length;
} bytes;

static void put_text(bytes *b, const char *text)
{
	memcpy(b->data + b->length, text, strlen(text));
	b->length += strlen(text);
}

/* The low `size` bytes of a pattern, lowest first or highest first. */
static void put_pattern(bytes *b, uint64_t pattern, size_t size, bool big)
{
	for (size_t i = 0; i < size; i++)
		b->data[b->length++] = (uint8_t)(pattern >> 8 * (big ? size - 1 - i : i));
}

static void put_float(bytes *b, float value, bool big)
{
	uint32_t pattern;
	memcpy(&pattern, &value, sizeof pattern);
	put_pattern(b, pattern, 4, big);
}

static void put_double(bytes *b, double value, bool big)
{
	uint64_t pattern;
	memcpy(&pattern, &value, sizeof pattern);
	put_pattern(b, pattern, 8, big);
}

/* Reads from memory of exactly the length, so that a sanitizer sees a byte too many. */
static gw_status read_bytes(gw_status (*read)(input_file *, scan *, gw_error *), const void *data,
							size_t length, scan *cloud, gw_error *error)
{
	uint8_t *copy = malloc(length + !length);
	memcpy(copy, data, length);
	input_file in = { .name = "test.file", .data = copy, .length = length };
	gw_status status = read(&in, cloud, error);
	free(copy);
	return status;
}

static scan read_ply(const char *text)
{
	scan cloud;
	gw_error error = { 0 };
	if (read_bytes(ply_read, text, strlen(text), &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return cloud;
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

/* ----------------------------------------------------------------------------------- PLY */

#define HEAD "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"

static void ply_of_text(void **state)
{
	(void)state;
	scan cloud = read_ply(HEAD "comment made  by hand\nobj_info scanned\nelement vertex 3\n"
							   "property double z\nproperty uchar red\nproperty float32 x\n"
							   "property int8 s\nproperty float y\nend_header\n"
							   "5400000.125 255 0.1 -128 nan\n 1 2\t3 4 inf \n\n7 8 9 10 11");
	assert_int_equal(cloud.count, 3);
	assert_int_equal(cloud.up, 'z');
	assert_int_equal(cloud.column_count, 5);
	assert_string_equal(cloud.column[0].name, "z");
	assert_int_equal(cloud.column[0].type, SCAN_FLOAT64);
	assert_string_equal(cloud.column[4].name, "y");
	assert_int_equal(cloud.comment_count, 2);
	assert_string_equal(cloud.comment[0], "made  by hand");
	assert_string_equal(cloud.comment[1], "obj_info scanned");
	assert_value(&cloud, "z", 0, 5400000.125);
	assert_value(&cloud, "x", 0, (double)0.1f);
	assert_value(&cloud, "s", 0, -128);
	assert_value(&cloud, "y", 0, (double)NAN);
	assert_value(&cloud, "y", 1, (double)INFINITY);
	assert_value(&cloud, "y", 2, 11);
	scan_clear(&cloud);
}

/* Every scalar type, under both of its names, in both byte orders. */
static void ply_of_every_type(void **state)
{
	(void)state;
	static const char *const names[2][SCAN_TYPE_COUNT] = {
		{ "char", "uchar", "short", "ushort", "int", "uint", "float", "double" },
		{ "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64" },
	};
	const uint64_t pattern[6] = { 0x80, 0x81, 0x8283, 0x8485, 0x86878889, 0x8a8b8c8d };
	const double value[6] = { -128, 129, -32125, 33925, -2037938039.0, 2324401293.0 };
	for (int form = 0; form < 4; form++) {
		bool big = form & 1;
		bytes b = { 0 };
		put_text(&b, big ? "ply\nformat binary_big_endian 1.0\nelement vertex 2\n"
						 : "ply\nformat binary_little_endian 1.0\nelement vertex 2\n");
		for (int t = 0; t < SCAN_TYPE_COUNT; t++) {
			char line[64];
			snprintf(line, sizeof line, "property %s t%d\n", names[form / 2][t], t);
			put_text(&b, line);
		}
		put_text(&b, XYZ "end_header\n");
		for (int i = 0; i < 2; i++) {
			for (int t = 0; t < 6; t++)
				put_pattern(&b, pattern[t], (size_t)1 << t / 2, big);
			put_float(&b, 0.1f, big);
			put_double(&b, 5.4e6 + 0.1, big);
			for (int k = 0; k < 3; k++)
				put_float(&b, (float)(i + k), big);
		}
		scan cloud;
		assert_int_equal(read_bytes(ply_read, b.data, b.length, &cloud, NULL), GW_OK);
		for (int t = 0; t < SCAN_TYPE_COUNT; t++) {
			char name[8];
			snprintf(name, sizeof name, "t%d", t);
			assert_int_equal(scan_find(&cloud, name)->type, t);
			assert_value(&cloud, name, 1, t < 6 ? value[t] : t == 6 ? (double)0.1f : 5.4e6 + 0.1);
		}
		assert_value(&cloud, "z", 1, 3);
		scan_clear(&cloud);
	}
}

/* A text of `count` vertices, i 2 i/4, with CRLF in some lines and `wrong` as the x of two. */
static char *many_vertices(size_t count, size_t first_wrong, size_t second_wrong)
{
	char *text;
	size_t length;
	FILE *file = open_memstream(&text, &length);
	fprintf(file, "ply\nformat ascii 1.0\nelement vertex %zu\n" XYZ "end_header\n", count);
	for (size_t i = 0; i < count; i++) {
		if (i == first_wrong || i == second_wrong)
			fputs("wrong", file);
		fprintf(file, "%zu 2 %.2f%s\n", i, (double)i / 4, i % 1000 ? "" : "\r");
	}
	fclose(file);
	return text;
}

/* Enough lines for several threads; of two faults the first is told, whoever finds the other. */
static void ply_text_on_threads(void **state)
{
	(void)state;
	const size_t count = 60000;
	char *text = many_vertices(count, count, count);
	for (uint32_t threads = 1; threads <= 4; threads += 3) {
		scan cloud;
		input_file in = {
			.name = "a.ply", .data = (uint8_t *)text, .length = strlen(text), .threads = threads
		};
		assert_int_equal(ply_read(&in, &cloud, NULL), GW_OK);
		assert_int_equal(cloud.count, count);
		for (size_t i = 0; i < count; i++)
			assert_true(scan_value(&cloud.column[0], i) == (double)i &&
						scan_value(&cloud.column[2], i) == (double)i / 4);
		scan_clear(&cloud);
		gw_error error;
		in.length -= 20;
		assert_int_equal(ply_read(&in, &cloud, &error), GW_ERROR_DATA);
		assert_non_null(strstr(error.text, "ends after 59999 of the 60000"));
	}
	free(text);
	text = many_vertices(count, 20000, 55000);
	input_file in = {
		.name = "a.ply", .data = (uint8_t *)text, .length = strlen(text), .threads = 4
	};
	gw_error error;
	scan cloud;
	assert_int_equal(ply_read(&in, &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "line 20008:"));
	free(text);
}

/* Elements before and after the vertices, and lists among their properties, in all encodings. */
static void ply_with_lists(void **state)
{
	(void)state;
	static const char *const formats_line[3] = { "ply\nformat ascii 1.0\n",
												 "ply\nformat binary_little_endian 1.0\n",
												 "ply\nformat binary_big_endian 1.0\n" };
	for (int form = 0; form < 3; form++) {
		bool big = form == 2;
		bytes b = { 0 };
		put_text(&b, formats_line[form]);
		put_text(&b, "element camera 1\nproperty int id\nproperty list uchar short v\n"
					 "element fixed 2\nproperty double d\n"
					 "element vertex 2\n" XYZ "property list uint double w\nproperty uchar red\n"
					 "element face 1\nproperty list uchar int vertex_indices\nend_header\n");
		if (form == 0) {
			put_text(&b, "7 3 1 2 3\n0.5\n0.25\n1 2 3 2 9 9 40\n4 5 6 0 50\n3 0 1 1\n");
		} else {
			put_pattern(&b, 7, 4, big);
			put_pattern(&b, 3, 1, big);
			for (uint64_t i = 0; i < 3; i++)
				put_pattern(&b, i, 2, big);
			put_double(&b, 0.5, big);
			put_double(&b, 0.25, big);
			for (int i = 0; i < 2; i++) {
				for (int k = 1; k <= 3; k++)
					put_float(&b, (float)(3 * i + k), big);
				put_pattern(&b, i == 0 ? 2 : 0, 4, big);
				for (int k = 0; k < 2 && i == 0; k++)
					put_double(&b, 9, big);
				put_pattern(&b, i == 0 ? 40 : 50, 1, big);
			}
			put_text(&b, "\003any 12 bytes");
		}
		scan cloud;
		gw_error error = { 0 };
		if (read_bytes(ply_read, b.data, b.length, &cloud, &error) != GW_OK)
			fail_msg("%s", error.text);
		assert_int_equal(cloud.count, 2);
		assert_int_equal(cloud.column_count, 4);
		assert_value(&cloud, "z", 0, 3);
		assert_value(&cloud, "x", 1, 4);
		assert_value(&cloud, "red", 0, 40);
		assert_value(&cloud, "red", 1, 50);
		scan_clear(&cloud);
	}
}

/* Header lines end in LF, CRLF or CR; a binary body may start with the byte of an LF. */
static void ply_with_any_line_end(void **state)
{
	(void)state;
	static const char *const ends[3] = { "\n", "\r\n", "\r" };
	for (int e = 0; e < 3; e++) {
		static const char *const lines[] = { "ply",
											 "format binary_little_endian 1.0",
											 "  comment  wide ",
											 "element\tvertex  1 ",
											 "",
											 "property uchar first",
											 "property float x",
											 "property float y",
											 "property float  z\t",
											 "end_header" };
		bytes b = { 0 };
		for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
			put_text(&b, lines[i]);
			put_text(&b, ends[e]);
		}
		put_pattern(&b, '\n', 1, false);
		for (int k = 0; k < 3; k++)
			put_float(&b, (float)k, false);
		scan cloud;
		assert_int_equal(read_bytes(ply_read, b.data, b.length, &cloud, NULL), GW_OK);
		assert_value(&cloud, "first", 0, '\n');
		assert_value(&cloud, "z", 0, 2);
		scan_clear(&cloud);
	}
	scan cloud = read_ply("ply\rformat ascii 1.0\relement vertex 1\rproperty int x\r"
						  "property int y\rproperty int z\rend_header\r1 2 3\r");
	assert_value(&cloud, "z", 0, 3);
	scan_clear(&cloud);
}

static void ply_with_other_names(void **state)
{
	(void)state;
	scan cloud = read_ply(HEAD "element vertex 1\nproperty int X\nproperty int Y\nproperty int z\n"
							   "property float normal_x\nproperty uchar diffuse_red\n"
							   "property uchar diffuse_green\nproperty uchar green\n"
							   "property float scalar_radiance_r\nend_header\n1 2 3 4 5 6 7 8\n");
	static const char *const names[] = {
		"x", "y", "z", "nx", "red", "diffuse_green", "green", "scalar_radiance_r"
	};
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		assert_value(&cloud, names[i], 0, (double)i + 1);
	scan_clear(&cloud);
}

/* Each of the axes is the thinnest of one splat, turned by 120 degrees about 1 1 1 and by some
 * length: x leads to y, y to z, z to x. */
static void ply_of_splats(void **state)
{
	(void)state;
	scan cloud = read_ply(
		HEAD "element vertex 5\n" XYZ "property float nx\nproperty float ny\nproperty float nz\n"
			 "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n"
			 "property float f_rest_0\nproperty float opacity\n"
			 "property float scale_0\nproperty float scale_1\n"
			 "property float scale_2\nproperty float rot_0\nproperty float rot_1\n"
			 "property float rot_2\nproperty float rot_3\nend_header\n"
			 "1 2 3 0 0 0 0 1 -1 7 0 -9 -1 -2 3 3 3 3\n"
			 "1 2 3 0 0 0 9 -9 0 7 2 -1 -9 -2 3 3 3 3\n"
			 "1 2 3 0 0 0 0 0 0 7 -2 -1 -2 -9 3 3 3 3\n"
			 "1 2 3 0 0 0 0 0 nan 7 nan -1 -2 -2.5 3 3 3 3\n"
			 "1 2 3 0 0 0 0 0 0 7 -0.01 -1 -2 -9 0 0 0 0\n");
	assert_int_equal(cloud.column_count, 10);
	assert_int_equal(cloud.up, 'Y');
	assert_non_null(strstr(cloud.comment[0], "3 of 5 splats are less than half opaque"));
	assert_non_null(strstr(cloud.comment[0], "of 3 that are flat"));
	/* 255 * (0.5 +- 0.28209479) is 199.4 and 55.6. */
	static const double color[5][3] = {
		{ 128, 199, 56 }, { 255, 1, 128 }, { 128, 128, 128 }, { 128, 128, 128 }, { 128, 128, 128 }
	};
	static const double axis[5][3] = { { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 0 } };
	/* 1 / (1 + exp(-2)) */
	static const double opacity[5] = { 0.5, 0.880797, 0.119203, 0, 0.4975 };
	for (size_t i = 0; i < 5; i++) {
		for (int k = 0; k < 3; k++) {
			static const char *const axes[] = { "axis_x", "axis_y", "axis_z" };
			static const char *const colors[] = { "red", "green", "blue" };
			assert_int_equal(scan_value(scan_find(&cloud, colors[k]), i), color[i][k]);
			assert_float_equal(scan_value(scan_find(&cloud, axes[k]), i), axis[i][k], 1e-6);
		}
		assert_float_equal(scan_value(scan_find(&cloud, "splat_opacity"), i), opacity[i], 1e-5);
	}
	scan_clear(&cloud);
}

/* Normals that somebody filled stay, and what is no splat has its opacity. */
static void ply_of_splats_with_normals(void **state)
{
	(void)state;
	scan cloud = read_ply(HEAD "element vertex 1\n" XYZ
							   "property float nx\nproperty float ny\nproperty float nz\n"
							   "property float f_dc_0\nproperty float opacity\n"
							   "property float scale_0\nproperty float rot_0\nend_header\n"
							   "1 2 3 0 0 -1 0 4 -9 1\n");
	assert_float_equal(scan_value(scan_find(&cloud, "nz"), 0), -1, 0);
	assert_null(scan_find(&cloud, "axis_x"));
	scan_clear(&cloud);
	cloud = read_ply(HEAD "element vertex 1\n" XYZ "property float opacity\n"
						  "property float f_dc_0\nproperty float scale_0\nend_header\n"
						  "1 2 3 0.25 1 1\n");
	assert_float_equal(scan_value(scan_find(&cloud, "opacity"), 0), 0.25, 0);
	assert_int_equal(cloud.comment_count, 0);
	scan_clear(&cloud);
}

static void ply_without_vertices(void **state)
{
	(void)state;
	scan cloud = read_ply(HEAD "element vertex 0\n" XYZ "end_header\n");
	assert_int_equal(cloud.count, 0);
	assert_int_equal(cloud.column_count, 3);
	scan_clear(&cloud);
}

/* Damaged files, and what the sentence must hold: the file's name, the place, what is wrong. */
static void ply_that_is_damaged(void **state)
{
	(void)state;
	static const struct {
		const char *text, *sentence;
	} cases[] = {
		{ "", "first line is not 'ply'" },
		{ "plyx\n", "first line is not 'ply'" },
		{ "ply\nformat ascii 1.0\nelement vertex 3\n", "end_header" },
		{ "ply\nelement vertex 1\n" XYZ "end_header\n1 2 3\n", "format" },
		{ "ply\nformat ascii 2.0\n", "line 2: 'format ascii 2.0'" },
		{ "ply\nformat binary 1.0\n", "binary_little_endian" },
		{ HEAD "end_header\n", "no element 'vertex'" },
		{ HEAD "nonsense here\n", "line 3: 'nonsense'" },
		{ HEAD "property int x\n", "element before its properties" },
		{ HEAD "element vertex -1\n", "line 3: '-1'" },
		{ HEAD "element vertex 99999999999999999999\n", "a count" },
		{ HEAD "element vertex 1\nelement vertex 1\n", "only one" },
		{ HEAD "element vertex 1\nproperty long x\n", "line 4: 'long'" },
		{ HEAD "element vertex 1\nproperty int x\nproperty int x\n", "line 5: 'x'" },
		{ HEAD "element vertex 1\nproperty list float int x\n", "integer type" },
		{ HEAD "element vertex 1\nproperty int x\nproperty int y\nend_header\n1 2\n", "'z'" },
		{ HEAD "element vertex 1\nproperty int x\nproperty int y\nproperty list int int z\n"
			   "end_header\n1 2 1 3\n",
		  "'z'" },
		{ HEAD "element vertex 3\n" XYZ "end_header\n1 2 3\n4 5 6\n", "bytes each" },
		{ HEAD "element vertex 2\n" XYZ "end_header\n1.00 2.00 3.00\n", "1 of the 2" },
		{ HEAD "element vertex 2\n" XYZ "end_header\n\n\n\n\n\n\n\n \n \n \n\n", "0 of the 2" },
		{ HEAD "element vertex 1\n" XYZ "end_header\n1.00 2.00\n", "line 8 ends" },
		{ HEAD "element vertex 1\n" XYZ "end_header\n1 2 3 4\n", "more values" },
		{ HEAD "element vertex 1\n" XYZ "end_header\n1 2 3\n4 5 6\n", "line 9 follows" },
		{ HEAD "element vertex 1\n" XYZ "end_header\n1 2,5 3\n", "'2,5' as 'y'" },
		{ HEAD "element vertex 1\n" XYZ "property char c\nend_header\n1 2 3 200\n", "char" },
		{ HEAD "element vertex 1\n" XYZ "property uint c\nend_header\n1 2 3 1.5\n", "whole" },
		{ HEAD "element vertex 1\n" XYZ "property list char int c\nend_header\n1 2 3 -1\n",
		  "length" },
		{ HEAD "element a 2\nproperty int i\nelement vertex 0\n" XYZ "end_header\n1\n", "'a'" },
		{ "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n" XYZ
		  "end_header\n123456789012",
		  "12 bytes each" },
		{ "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ
		  "end_header\n12345678901234567890123456",
		  "14 bytes follow" },
		{ "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list int double l\n" XYZ
		  "end_header\n\377\377\377\377234567890123",
		  "list 'l'" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		scan cloud;
		gw_error error = { 0 };
		gw_status status =
			read_bytes(ply_read, cases[i].text, strlen(cases[i].text), &cloud, &error);
		if (status != GW_ERROR_DATA || !strstr(error.text, cases[i].sentence) ||
			!strstr(error.text, "test.file"))
			fail_msg("case %zu: status %d, '%s' lacks '%s'", i, status, error.text,
					 cases[i].sentence);
		assert_int_equal(cloud.column_count, 0);
		assert_int_equal(cloud.comment_count, 0);
	}
}

/* Fills a scan with a column of each type. */
static scan make_scan(size_t count)
{
	static const char *const names[] = { "x", "y", "z", "nx", "red", "s8", "u16", "i16", "u32" };
	static const scan_type types[] = { SCAN_FLOAT64, SCAN_FLOAT64, SCAN_FLOAT64,
									   SCAN_FLOAT32, SCAN_UINT8,   SCAN_INT8,
									   SCAN_UINT16,  SCAN_INT16,   SCAN_UINT32 };
	scan cloud = { .count = count, .up = 'z' };
	for (size_t c = 0; c < sizeof names / sizeof *names; c++) {
		scan_column *column = scan_add_column(&cloud, names[c], types[c], NULL);
		assert_non_null(column);
		uint8_t *data = column->data;
		for (size_t i = 0; i < count * scan_type_size(types[c]); i++)
			data[i] = (uint8_t)((i + c) * 2654435761u >> 11);
	}
	return cloud;
}

static void assert_same_scan(const scan *a, const scan *b)
{
	assert_int_equal(a->count, b->count);
	assert_int_equal(a->column_count, b->column_count);
	for (size_t c = 0; c < a->column_count; c++) {
		assert_string_equal(a->column[c].name, b->column[c].name);
		assert_int_equal(a->column[c].type, b->column[c].type);
		assert_memory_equal(a->column[c].data, b->column[c].data,
							a->count * scan_type_size(a->column[c].type));
	}
	assert_int_equal(a->comment_count, b->comment_count);
	for (size_t c = 0; c < a->comment_count; c++)
		assert_string_equal(a->comment[c], b->comment[c]);
}

static void ply_comes_back_bit_by_bit(void **state)
{
	(void)state;
	const size_t counts[] = { 0, 1, 1024, 2500 };
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
		scan cloud = make_scan(counts[i]), back;
		output_file *out;
		gw_error error = { 0 };
		scan_add_comment(&cloud, "units radiometric", NULL);
		scan_add_comment(&cloud, "obj_info from a scanner", NULL);
		assert_int_equal(output_file_create(&out, in_folder("a.ply"), true, NULL), GW_OK);
		assert_int_equal(ply_write(out, &cloud, NULL), GW_OK);
		assert_int_equal(output_file_commit(&out, NULL), GW_OK);
		if (format_read(in_folder("a.ply"), NULL, &back, &error) != GW_OK)
			fail_msg("%s", error.text);
		assert_same_scan(&cloud, &back);
		scan_clear(&cloud);
		scan_clear(&back);
	}
	unlink(in_folder("a.ply"));
}

/* Names and comments from elsewhere cannot break a header. */
static void ply_header_cannot_be_injected(void **state)
{
	(void)state;
	scan cloud = make_scan(1), back;
	output_file *out;
	scan_add_comment(&cloud, "a\nelement vertex 9\rend_header", NULL);
	assert_non_null(scan_add_column(&cloud, "my field\n", SCAN_UINT8, NULL));
	assert_non_null(scan_add_column(&cloud, "", SCAN_UINT8, NULL));
	assert_int_equal(output_file_create(&out, in_folder("a.ply"), true, NULL), GW_OK);
	assert_int_equal(ply_write(out, &cloud, NULL), GW_OK);
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	assert_int_equal(format_read(in_folder("a.ply"), NULL, &back, NULL), GW_OK);
	assert_string_equal(back.comment[0], "a element vertex 9 end_header");
	assert_non_null(scan_find(&back, "my_field_"));
	assert_non_null(scan_find(&back, "unnamed"));
	scan_clear(&cloud);
	scan_clear(&back);
	unlink(in_folder("a.ply"));
}

/* -------------------------------------------------------------------------------- .cloud */

static void cloud_is_read(void **state)
{
	(void)state;
	bytes b = { 0 };
	put_pattern(&b, 2, 4, false);
	for (int i = 0; i < 2; i++) {
		for (int k = 0; k < 6; k++)
			put_float(&b, (float)(10 * i + k) * 0.5f, false);
		put_pattern(&b, 0x332211, 3, false);
	}
	scan cloud;
	assert_int_equal(read_bytes(cloud_read, b.data, b.length, &cloud, NULL), GW_OK);
	assert_int_equal(cloud.count, 2);
	assert_int_equal(cloud.up, 'y');
	assert_value(&cloud, "x", 1, 5);
	assert_value(&cloud, "nz", 1, 7.5);
	assert_value(&cloud, "red", 1, 0x11);
	assert_value(&cloud, "blue", 0, 0x33);
	scan_clear(&cloud);

	/* Any other length, and any other count, is a lie. */
	gw_error error = { 0 };
	for (size_t length = 0; length < b.length; length++) {
		assert_int_equal(read_bytes(cloud_read, b.data, length, &cloud, &error), GW_ERROR_DATA);
		assert_non_null(strstr(error.text, "test.file"));
	}
	b.data[3] = 0x80;
	assert_int_equal(read_bytes(cloud_read, b.data, b.length, &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "-2147483646"));
}

static void cloud_comes_back(void **state)
{
	(void)state;
	scan up_z =
		read_ply(HEAD "element vertex 1\n" XYZ "property float nx\nproperty float ny\n"
					  "property float nz\nproperty ushort red\nproperty ushort green\n"
					  "property ushort blue\nend_header\n1 2 3 0.1 0.2 0.3 0 32896 65535\n");
	scan back, again;
	output_file *out;
	assert_int_equal(output_file_create(&out, in_folder("a.cloud"), true, NULL), GW_OK);
	assert_int_equal(cloud_write(out, &up_z, NULL), GW_OK);
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	assert_int_equal(format_read(in_folder("a.cloud"), NULL, &back, NULL), GW_OK);
	assert_value(&back, "x", 0, 1);
	assert_value(&back, "y", 0, 3);
	assert_value(&back, "z", 0, -2);
	assert_value(&back, "nz", 0, -(double)0.2f);
	assert_value(&back, "green", 0, 128);
	assert_value(&back, "blue", 0, 255);

	/* What is y up already stays as it is. */
	assert_int_equal(output_file_create(&out, in_folder("a.cloud"), true, NULL), GW_OK);
	assert_int_equal(cloud_write(out, &back, NULL), GW_OK);
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	assert_int_equal(format_read(in_folder("a.cloud"), "cloud", &again, NULL), GW_OK);
	assert_same_scan(&back, &again);
	scan_clear(&up_z);
	scan_clear(&back);
	scan_clear(&again);
	unlink(in_folder("a.cloud"));
}

static void cloud_refuses_large_coordinates(void **state)
{
	(void)state;
	scan cloud = read_ply(HEAD "element vertex 1\nproperty double x\nproperty double y\n"
							   "property double z\nend_header\n5400000.1 0 0\n");
	output_file *out;
	gw_error error = { 0 };
	assert_int_equal(output_file_create(&out, in_folder("a.cloud"), true, NULL), GW_OK);
	assert_int_equal(cloud_write(out, &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "5400000.1"));
	output_file_abandon(&out);
	scan_clear(&cloud);
}

/* ------------------------------------------------------------------------------ the table */

static void every_format_is_found(void **state)
{
	(void)state;
	for (size_t f = 0; formats[f]; f++) {
		assert_ptr_equal(format_by_name(formats[f]->name), formats[f]);
		assert_true(formats[f]->read || formats[f]->write);
		assert_true(strlen(formats[f]->description) > 0);
		for (const char *const *e = formats[f]->extensions; *e; e++) {
			char path[64];
			snprintf(path, sizeof path, "dir.x/name.tar.%s", *e);
			assert_ptr_equal(format_by_path(path), formats[f]);
		}
	}
	assert_null(format_by_name("none"));
	assert_null(format_by_path("dir.ply/name"));
	assert_ptr_equal(format_by_path("A.PLY"), &ply_format);
}

static void content_goes_before_the_name(void **state)
{
	(void)state;
	scan cloud;
	gw_error error = { 0 };
	FILE *file = fopen(in_folder("a.cloud"), "w");
	fputs(HEAD "element vertex 1\n" XYZ "end_header\n1 2 3\n", file);
	fclose(file);
	assert_int_equal(format_read(in_folder("a.cloud"), NULL, &cloud, NULL), GW_OK);
	scan_clear(&cloud);
	assert_int_equal(format_read(in_folder("a.cloud"), "cloud", &cloud, &error), GW_ERROR_DATA);
	assert_int_equal(format_read(in_folder("a.cloud"), "none", &cloud, &error), GW_ERROR_USAGE);
	assert_non_null(strstr(error.text, "ply"));
	assert_int_equal(rename(in_folder("a.cloud"), in_folder("a.none")), 0);
	assert_int_equal(truncate(in_folder("a.none"), 2), 0);
	assert_int_equal(format_read(in_folder("a.none"), NULL, &cloud, &error), GW_ERROR_DATA);
	assert_int_equal(truncate(in_folder("a.none"), 0), 0);
	assert_int_equal(format_read(in_folder("a.none"), NULL, &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "empty"));
	unlink(in_folder("a.none"));
}

/* ------------------------------------------------------------------------------- OpenVDB */

enum { VOXELS = 1000 };

static int32_t cell[3 * VOXELS];
static float value[3 * VOXELS], density[VOXELS];

static gw_voxels make_voxels(int32_t spread)
{
	for (int32_t i = 0; i < VOXELS; i++) {
		cell[3 * i] = i % 10 * spread;
		cell[3 * i + 1] = i / 10 % 10 * spread;
		cell[3 * i + 2] = i / 100 * spread;
		density[i] = (float)(i % 8) / 8.0f;
		for (int k = 0; k < 3; k++)
			value[3 * i + k] = (float)(i * k);
	}
	value[1] = 1e6f;
	return (gw_voxels){ .count = VOXELS,
						.cell = cell,
						.density = density,
						.radiance = value,
						.albedo = value,
						.emission = value,
						.normal = value,
						.origin = { 10, 20, -3 },
						.size = 0.05 };
}

static void assert_same_file(const char *a, const char *b)
{
	input_file first, second;
	assert_int_equal(input_file_open(&first, a, NULL), GW_OK);
	assert_int_equal(input_file_open(&second, b, NULL), GW_OK);
	assert_int_equal(first.length, second.length);
	assert_memory_equal(first.data, second.data, first.length);
	input_file_close(&first);
	input_file_close(&second);
}

/* A wall of 4 x 4 voxels of density 1 and a lone one of 1/2, on both sides of 0, in cells twice and
 * two and a half times as wide. */
static void voxels_are_merged(void **state)
{
	(void)state;
	int32_t place[51];
	float opacity[17], vector[51], zero[51] = { 0 };
	for (size_t i = 0; i < 17; i++) {
		const int32_t at[3] = { (int32_t)(i % 4) - 2, i < 16 ? 5 : 40, (int32_t)(i / 4) - 2 };
		memcpy(place + 3 * i, at, sizeof at);
		opacity[i] = i < 16 ? 1.0f : 0.5f;
		for (size_t k = 0; k < 3; k++)
			vector[3 * i + k] = (float)(i % 4 * (k + 1));
	}
	const gw_voxels voxels = { 17, place, opacity, vector, zero, zero, zero, { 1, 2, 3 }, 0.25 };
	gw_voxels m;
	gw_error error = { 0 };
	assert_int_equal(voxel_merge(&voxels, 0.5, &m, &error), GW_OK);
	assert_int_equal(m.count, 5);
	const int32_t expected[15] = { -1, 2, -1, 0, 2, -1, -1, 2, 0, 0, 2, 0, -1, 20, 1 };
	assert_memory_equal(m.cell, expected, sizeof expected);
	for (size_t i = 0; i < 5; i++) {
		/* Four whole faces of a quarter cover a place's face; half of one is an eighth. */
		assert_true(m.density[i] == (i < 4 ? 1.0f : 0.125f));
		/* Columns 0 and 1, or 2 and 3; the lone voxel is of column 0. */
		float mean = i == 4 ? 0.0f : i % 2 ? 2.5f : 0.5f;
		assert_true(m.radiance[3 * i] == mean && m.radiance[3 * i + 2] == 3.0f * mean);
	}
	assert_true(m.size == 0.5 && m.origin[2] == 3.0);
	voxel_merge_clear(&m);
	assert_int_equal(voxel_merge(&voxels, 0.625, &m, &error), GW_OK);
	double covered = 0.0;
	for (size_t i = 0; i < m.count; i++)
		covered += (double)m.density[i] * 0.625 * 0.625;
	/* 16.5 faces of the voxels, but for the rounding of floats. */
	assert_true(fabs(covered - 16.5 * 0.0625) < 1e-6);
	voxel_merge_clear(&m);
	assert_int_equal(voxel_merge(&voxels, 0.2, &m, &error), GW_ERROR_USAGE);
	assert_non_null(strstr(error.text, "0.25 m wide"));
	assert_int_equal(voxel_merge(&voxels, NAN, &m, &error), GW_ERROR_USAGE);
}

/* vdb_write reads the file back; here we see that the same voxels give the same bytes. */
static void vdb_is_written(void **state)
{
	(void)state;
	gw_voxels voxels = make_voxels(1);
	vdb_text text = { "units", "radiometric" };
	uint64_t clamped = 99;
	vdb_metadata metadata = { .text = &text, .text_count = 1, .clamped = &clamped };
	gw_error error = { 0 };
	if (vdb_write(in_folder("a.vdb"), false, &voxels, &metadata, &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_int_equal(clamped, 0);
	assert_int_equal(vdb_write(in_folder("b.vdb"), false, &voxels, &metadata, &error), GW_OK);
	assert_same_file(in_folder("a.vdb"), in_folder("b.vdb"));
	assert_int_equal(vdb_write(in_folder("b.vdb"), false, &voxels, &metadata, &error),
					 FILE_ERROR_CREATE);

	/* One value over 65504 in each of four grids. */
	metadata.half = true;
	voxels.origin[0] = 5e5;
	assert_int_equal(vdb_write(in_folder("b.vdb"), true, &voxels, &metadata, &error), GW_OK);
	assert_int_equal(clamped, 4);
	unlink(in_folder("a.vdb"));
	unlink(in_folder("b.vdb"));
}

enum { GRID_POINTS = 500 };

/* Points all over a few voxels, one of them nowhere. */
static vdb_points make_points(double spread)
{
	static double position[3 * GRID_POINTS];
	static float number[3 * GRID_POINTS];
	for (size_t i = 0; i < 3 * GRID_POINTS; i++) {
		position[i] = 10.0 + spread * (double)(i * 7919 % 1000) / 1000.0;
		number[i] = (float)i / 8.0f;
	}
	position[30] = NAN;
	return (vdb_points){ GRID_POINTS, position, number, number, number };
}

/* Points that share voxels keep their order, so that the bytes are the same; half is not theirs. */
static void vdb_points_are_written(void **state)
{
	(void)state;
	gw_voxels voxels = make_voxels(1);
	vdb_points points = make_points(1.0);
	vdb_metadata metadata = { .points = &points, .half = true };
	gw_error error = { 0 };
	if (vdb_write(in_folder("a.vdb"), true, &voxels, &metadata, &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_int_equal(vdb_write(in_folder("b.vdb"), true, &voxels, &metadata, &error), GW_OK);
	assert_same_file(in_folder("a.vdb"), in_folder("b.vdb"));
	/* 500 points within 1 m fill a few leaves; within 10 km a leaf each. */
	metadata.memory = 8 << 20;
	assert_int_equal(vdb_write(in_folder("b.vdb"), true, &voxels, &metadata, &error), GW_OK);
	points = make_points(1e4);
	assert_int_equal(vdb_write(in_folder("b.vdb"), true, &voxels, &metadata, &error),
					 GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "the point grid of 499 points"));
	points = make_points(1e9);
	assert_int_equal(vdb_write(in_folder("b.vdb"), true, &voxels, &metadata, &error),
					 GW_ERROR_DATA);
	points.count = 0;
	assert_int_equal(vdb_write(in_folder("b.vdb"), true, &voxels, &metadata, &error),
					 GW_ERROR_DATA);
	unlink(in_folder("a.vdb"));
	unlink(in_folder("b.vdb"));
}

static bool to_stream(void *user, const void *data, size_t length)
{
	FILE *stream = user;
	return fwrite(data, 1, length, stream) == length;
}

/* What a full disk or a fault in OpenVDB would leave behind is noticed when it is read back. */
static void vdb_is_read_back(void **state)
{
	(void)state;
	gw_status (*encode)(const gw_voxels *, const vdb_metadata *, vdb_sink, void *, vdb_digest *,
						gw_error *);
	gw_status (*verify)(const char *, const vdb_digest *, gw_error *);
	void *library = dlopen("libglowworm-vdb.so", RTLD_NOW | RTLD_LOCAL);
	assert_non_null(library);
	void *address[2] = { dlsym(library, "vdb_encode"), dlsym(library, "vdb_verify") };
	memcpy(&encode, &address[0], sizeof encode);
	memcpy(&verify, &address[1], sizeof verify);

	gw_voxels voxels = make_voxels(3);
	vdb_points points = make_points(1.0);
	vdb_metadata metadata = { .half = true, .points = &points };
	vdb_digest digest;
	gw_error error = { 0 };
	char path[160];
	snprintf(path, sizeof path, "%s/a.vdb", folder);
	FILE *file = fopen(path, "w");
	assert_int_equal(encode(&voxels, &metadata, to_stream, file, &digest, &error), GW_OK);
	long length = ftell(file);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(digest.voxels[0], VOXELS);
	if (verify(path, &digest, &error) != GW_OK)
		fail_msg("%s", error.text);
	for (int g = 0; g < VDB_GRIDS; g++) {
		vdb_digest other = digest;
		other.values[g] ^= 1;
		assert_int_equal(verify(path, &other, &error), FILE_ERROR_IO);
		other = digest;
		other.voxels[g]++;
		assert_int_equal(verify(path, &other, &error), FILE_ERROR_IO);
	}
	assert_int_equal(digest.points, GRID_POINTS - 1);
	vdb_digest others[2] = { digest, digest };
	others[0].points++;
	others[1].point_values ^= 1;
	for (int i = 0; i < 2; i++)
		assert_int_equal(verify(path, &others[i], &error), FILE_ERROR_IO);
	for (int part = 7; part >= 0; part--) {
		assert_int_equal(truncate(path, length * part / 8), 0);
		assert_int_equal(verify(path, &digest, &error), FILE_ERROR_IO);
	}
	unlink(path);
}

static void vdb_refuses(void **state)
{
	(void)state;
	gw_error error = { 0 };
	gw_voxels voxels = make_voxels(1);
	vdb_metadata metadata = { .memory = 4 << 20 };
	/* 1000 voxels side by side fill 8 leaves: under 4 MB. Spread out they take a leaf and a lower
	 * node each. */
	assert_int_equal(vdb_write(in_folder("a.vdb"), true, &voxels, &metadata, &error), GW_OK);
	unlink(in_folder("a.vdb"));
	voxels = make_voxels(200);
	assert_int_equal(vdb_write(in_folder("a.vdb"), true, &voxels, &metadata, &error),
					 GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "1000 leaf nodes"));
	metadata.memory = 0;
	voxels.size = -1.0;
	assert_int_equal(vdb_write(in_folder("a.vdb"), true, &voxels, &metadata, &error),
					 GW_ERROR_DATA);
	voxels = make_voxels(1000000);
	assert_int_equal(vdb_write(in_folder("a.vdb"), true, &voxels, &metadata, &error),
					 GW_ERROR_DATA);
	voxels.count = 0;
	assert_int_equal(vdb_write(in_folder("a.vdb"), true, &voxels, &metadata, &error),
					 GW_ERROR_DATA);
	voxels = make_voxels(1);
	assert_int_equal(vdb_write("/dev/full", true, &voxels, &metadata, &error), FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "No space left"));
	assert_int_not_equal(access(in_folder("a.vdb"), F_OK), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ply_of_text),
		cmocka_unit_test(ply_of_every_type),
		cmocka_unit_test(ply_with_lists),
		cmocka_unit_test(ply_text_on_threads),
		cmocka_unit_test(ply_with_any_line_end),
		cmocka_unit_test(ply_with_other_names),
		cmocka_unit_test(ply_of_splats),
		cmocka_unit_test(ply_of_splats_with_normals),
		cmocka_unit_test(ply_without_vertices),
		cmocka_unit_test(ply_that_is_damaged),
		cmocka_unit_test(ply_comes_back_bit_by_bit),
		cmocka_unit_test(ply_header_cannot_be_injected),
		cmocka_unit_test(cloud_is_read),
		cmocka_unit_test(cloud_comes_back),
		cmocka_unit_test(cloud_refuses_large_coordinates),
		cmocka_unit_test(every_format_is_found),
		cmocka_unit_test(content_goes_before_the_name),
		cmocka_unit_test(voxels_are_merged),
		cmocka_unit_test(vdb_is_written),
		cmocka_unit_test(vdb_points_are_written),
		cmocka_unit_test(vdb_is_read_back),
		cmocka_unit_test(vdb_refuses),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
