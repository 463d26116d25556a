/*
 * LAS: every point format from file to scan to file, the grid of the coordinates, colours, extra
 * bytes, coordinate systems, and headers that say what is not so.
 */
#include "las/las_format.h"
#include "las/las_grid.h"
#include "las/las_header.h"
#include "laz_samples.h"
#include "files/little_endian.h"
#include "table/format_table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

static char path[64];

static int make_path(void **state)
{
	(void)state;
	snprintf(path, sizeof path, "/tmp/glowworm-las-%ld.las", (long)getpid());
	return 0;
}

static int remove_path(void **state)
{
	(void)state;
	unlink(path);
	return 0;
}

static scan read_bytes(const uint8_t *file, size_t length)
{
	input_file in = { .name = "sample.las", .data = file, .length = length };
	scan cloud;
	gw_error error = { 0 };
	if (las_read(&in, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return cloud;
}

static gw_status write_file(const scan *cloud, gw_error *error)
{
	output_file *out;
	gw_status status = output_file_create(&out, path, true, error);
	if (status == GW_OK)
		status = las_write(out, cloud, error);
	if (status == GW_OK)
		return output_file_commit(&out, error);
	output_file_abandon(&out);
	return status;
}

static scan read_file(void)
{
	scan cloud;
	gw_error error = { 0 };
	if (format_read(path, NULL, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return cloud;
}

static scan write_and_read(const scan *cloud)
{
	gw_error error = { 0 };
	if (write_file(cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	return read_file();
}

static void same_columns(const scan *a, const scan *b)
{
	assert_int_equal(a->count, b->count);
	for (size_t c = 0; c < a->column_count; c++) {
		const scan_column *one = &a->column[c], *other = scan_find(b, one->name);
		if (!other || one->type != other->type ||
			memcmp(one->data, other->data, a->count * scan_type_size(one->type)) != 0)
			fail_msg("column %s differs", one->name);
	}
	assert_int_equal(a->column_count, b->column_count);
}

static bool has_comment(const scan *cloud, const char *part)
{
	for (size_t c = 0; c < cloud->comment_count; c++)
		if (strstr(cloud->comment[c], part))
			return true;
	return false;
}

static double value(const scan *cloud, const char *name, size_t i)
{
	const scan_column *column = scan_find(cloud, name);
	if (!column)
		fail_msg("there is no column %s", name);
	return scan_value(column, i);
}

/* --------------------------------------------------------------------------------- both ways */

static void every_point_format(void **state)
{
	(void)state;
	static uint8_t file[LAZ_SAMPLE_BYTES], written[8 * LAZ_SAMPLE_BYTES];
	for (unsigned format_number = 0; format_number < LAS_FORMATS; format_number++) {
		size_t length = laz_sample_plain(format_number, 3, file);
		scan cloud = read_bytes(file, length), back = write_and_read(&cloud);
		same_columns(&cloud, &back);
		scan_clear(&back);
		scan_clear(&cloud);
		/* Without waveforms the record's own bytes are the same, in the same format. */
		FILE *stream = fopen(path, "rb");
		assert_non_null(stream);
		size_t got = fread(written, 1, sizeof written, stream);
		fclose(stream);
		bool wave = format_number == 4 || format_number == 5 || format_number >= 9;
		size_t own = laz_sample_record_bytes(format_number), record = load_16(written + 105);
		assert_int_equal(got, load_32(written + 96) + record * LAZ_SAMPLE_POINTS);
		for (size_t i = 0; i < LAZ_SAMPLE_POINTS && !wave; i++)
			assert_memory_equal(written + load_32(written + 96) + i * record,
								file + length - (LAZ_SAMPLE_POINTS - i) * (own + 3), own + 3);
		if (!wave)
			assert_int_equal(written[104], format_number);
	}
}

/* What a program that knows nothing of us reads in the header. */
static void header_says_what_is(void **state)
{
	(void)state;
	static uint8_t file[LAZ_SAMPLE_BYTES], h[LAS_HEADER_BYTES_1_4];
	scan cloud = read_bytes(file, laz_sample_plain(7, 0, file));
	gw_error error = { 0 };
	assert_int_equal(write_file(&cloud, &error), GW_OK);
	FILE *stream = fopen(path, "rb");
	assert_int_equal(fread(h, 1, sizeof h, stream), sizeof h);
	fclose(stream);
	assert_int_equal(h[24] * 10 + h[25], 14);
	assert_int_equal(load_16(h + 94), 375);
	assert_int_equal(load_32(h + 107), 0);
	assert_int_equal(load_64(h + 247), LAZ_SAMPLE_POINTS);
	for (size_t r = 0; r < 15; r++)
		assert_int_equal(load_64(h + 255 + 8 * r), r < 3 ? LAZ_SAMPLE_POINTS / 3 : 0);
	for (size_t k = 0; k < 3; k++) {
		static const char *const names[3] = { "x", "y", "z" };
		double low = INFINITY, high = -INFINITY;
		for (size_t i = 0; i < cloud.count; i++) {
			low = fmin(low, value(&cloud, names[k], i));
			high = fmax(high, value(&cloud, names[k], i));
		}
		assert_true(load_double(h + 179 + 16 * k) == high);
		assert_true(load_double(h + 187 + 16 * k) == low);
		assert_true(load_double(h + 131 + 8 * k) == 0.001);
	}
	scan_clear(&cloud);
}

/* -------------------------------------------------------------------------------- coordinates */

static scan make_cloud(size_t count, scan_type type)
{
	scan cloud = { .count = count, .up = 'z' };
	for (int k = 0; k < 3; k++)
		assert_non_null(scan_add_column(&cloud, (const char *[]){ "x", "y", "z" }[k], type, NULL));
	return cloud;
}

static void set(scan *cloud, const char *name, size_t i, double v)
{
	scan_column *column = scan_find(cloud, name);
	if (column->type == SCAN_FLOAT64)
		((double *)column->data)[i] = v;
	else
		((float *)column->data)[i] = (float)v;
}

/* Decimal coordinates come back bit for bit, on the coarsest grid that does it. */
static void decimal_grids(void **state)
{
	(void)state;
	scan cloud = make_cloud(100, SCAN_FLOAT64);
	for (size_t i = 0; i < 100; i++) {
		set(&cloud, "x", i, (double)(50000012 + (int)i * 7) * 0.01);
		set(&cloud, "y", i, (double)(i * i) * 1e-6);
		set(&cloud, "z", i, -3.0 * (double)i);
	}
	static const double scale[3] = { 0.01, 1e-6, 1.0 };
	for (int k = 0; k < 3; k++) {
		las_grid grid;
		assert_int_equal(las_grid_find(&cloud, k, "a.las", &grid, NULL), GW_OK);
		assert_true(grid.exact);
		assert_true(grid.scale == scale[k]);
	}
	scan back = write_and_read(&cloud);
	for (size_t i = 0; i < 100; i++) {
		assert_true(value(&back, "x", i) == value(&cloud, "x", i));
		assert_true(value(&back, "y", i) == value(&cloud, "y", i));
		assert_true(value(&back, "z", i) == value(&cloud, "z", i));
	}
	scan_clear(&back);
	scan_clear(&cloud);
}

/* Numbers that no grid holds are rounded to its finest step, and the file says so. */
static void rounded_grids(void **state)
{
	(void)state;
	scan cloud = make_cloud(50, SCAN_FLOAT64);
	for (size_t i = 0; i < 50; i++) {
		set(&cloud, "x", i, 500000.0 + sqrt((double)i));
		set(&cloud, "y", i, 100.0 * cbrt((double)i));
		set(&cloud, "z", i, (double)i);
	}
	scan back = write_and_read(&cloud);
	assert_true(has_comment(&back, "glowworm rounded x to steps of "));
	assert_false(has_comment(&back, "glowworm rounded z"));
	/* A range of 7 m in 2^31 steps each way around its middle: steps of 1e-8, half of which a
	 * value may move, and the double itself near 5e5 by 3e-11 at each of two roundings. */
	for (size_t i = 0; i < 50; i++)
		assert_true(fabs(value(&back, "x", i) - value(&cloud, "x", i)) <= 0.5e-8 + 2 * 3e-11);
	scan_clear(&back);
	scan_clear(&cloud);
}

/* A scan that may be rounded lies on a grid as coarse as it says, wherever that reaches, and no
 * grid is coarser than needs be; the file says so. */
static void grids_of_a_step(void **state)
{
	(void)state;
	static const double offset[3] = { 0.0, 4e6 + 1.0, 0.0 }, scale[3] = { 1e-4, 1e-4, 1e-3 };
	scan cloud = make_cloud(50, SCAN_FLOAT64);
	cloud.step = 1e-4;
	for (size_t i = 0; i < 50; i++) {
		set(&cloud, "x", i, 100.0 * cbrt((double)i));
		set(&cloud, "y", i, 4e6 + cbrt((double)i));
		set(&cloud, "z", i, 0.001 * (double)i);
	}
	for (int k = 0; k < 3; k++) {
		las_grid grid;
		assert_int_equal(las_grid_find(&cloud, k, "a.las", &grid, NULL), GW_OK);
		assert_true(grid.exact == (k == 2));
		assert_true(grid.scale == scale[k]);
		assert_true(grid.offset == offset[k]);
	}
	scan back = write_and_read(&cloud);
	assert_true(has_comment(&back, "glowworm rounded x to steps of 0.0001"));
	/* Half a step; and the double itself, near 4e6, by 2^-31 at each of two roundings. */
	for (size_t i = 0; i < 50; i++) {
		assert_true(fabs(value(&back, "x", i) - value(&cloud, "x", i)) <= 0.5e-4 + 1e-12);
		assert_true(fabs(value(&back, "y", i) - value(&cloud, "y", i)) <= 0.5e-4 + 0x1p-30);
		assert_true(value(&back, "z", i) == value(&cloud, "z", i));
	}
	scan_clear(&back);
	/* The step does not reach from end to end, and a finer one does not either. */
	las_grid grid;
	cloud.step = 1e-7;
	set(&cloud, "x", 0, 1e4);
	assert_int_equal(las_grid_find(&cloud, 0, "a.las", &grid, NULL), GW_OK);
	assert_true(grid.scale == 1e-5);
	scan_clear(&cloud);
}

static void coordinates_that_are_refused(void **state)
{
	(void)state;
	gw_error error = { 0 };
	scan cloud = make_cloud(3, SCAN_FLOAT64);
	set(&cloud, "x", 1, 0.1);
	set(&cloud, "x", 2, 1e7 + 1e-4);
	assert_int_equal(write_file(&cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "millimetre"));
	set(&cloud, "x", 2, NAN);
	assert_int_equal(write_file(&cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "point 2 is no number"));
	scan_remove_column(&cloud, "y");
	set(&cloud, "x", 2, 0.0);
	assert_int_equal(write_file(&cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "coordinate 'y'"));
	scan_clear(&cloud);
}

/* ------------------------------------------------------------------------------------ columns */

static void *add(scan *cloud, const char *name, scan_type type)
{
	scan_column *column = scan_add_column(cloud, name, type, NULL);
	assert_non_null(column);
	return column->data;
}

/* What a bake adds: a preview of 8 bits, light as floats, and names that are long. */
static void lit_points(void **state)
{
	(void)state;
	scan cloud = make_cloud(4, SCAN_FLOAT32);
	static const char *const colors[3] = { "red", "green", "blue" };
	for (int k = 0; k < 3; k++) {
		uint8_t *data = add(&cloud, colors[k], SCAN_UINT8);
		for (int i = 0; i < 4; i++)
			data[i] = (uint8_t)(85 * i);
	}
	float *radiance = add(&cloud, "scalar_radiance_r", SCAN_FLOAT32);
	radiance[0] = 1.5e-7f, radiance[1] = INFINITY, radiance[2] = NAN, radiance[3] = -0.0f;
	double *intensity = add(&cloud, "intensity", SCAN_FLOAT64);
	intensity[1] = 0.25;
	static const char *const long_names[2] = { "a_name_of_more_than_thirty-two_bytes_1",
											   "a_name_of_more_than_thirty-two_bytes_2" };
	((int8_t *)add(&cloud, long_names[0], SCAN_INT8))[2] = -128;
	((uint32_t *)add(&cloud, long_names[1], SCAN_UINT32))[3] = UINT32_MAX;
	assert_int_equal(scan_add_comment(&cloud, "glowworm units: some", NULL), GW_OK);

	scan back = write_and_read(&cloud);
	for (size_t i = 0; i < 4; i++)
		assert_true(value(&back, "green", i) == 85.0 * 257.0 * (double)i);
	assert_memory_equal(scan_find(&back, "scalar_radiance_r")->data, radiance, 16);
	assert_int_equal(scan_find(&back, "scalar_radiance_r")->type, SCAN_FLOAT32);
	/* The field holds integers only, so the column comes back from the extra bytes. */
	assert_true(value(&back, "intensity", 1) == 0.25);
	/* Names that are longer than LAS has room for come back whole, and leave no comment. */
	assert_true(value(&back, long_names[0], 2) == -128.0);
	assert_true(value(&back, long_names[1], 3) == (double)UINT32_MAX);
	assert_false(has_comment(&back, "glowworm column"));
	assert_true(has_comment(&back, "glowworm units: some"));
	assert_true(value(&back, "return_number", 0) == 1.0);
	scan_clear(&back);

	/* Beside what points reflect, bytes of colour are for viewers, which take the upper byte. */
	static const char *const albedo[3] = { "albedo_r", "albedo_g", "albedo_b" };
	for (int k = 0; k < 3; k++)
		add(&cloud, albedo[k], SCAN_UINT8);
	back = write_and_read(&cloud);
	for (size_t i = 0; i < 4; i++)
		assert_true(value(&back, "green", i) == 85.0 * 256.0 * (double)i);
	scan_clear(&back);
	scan_clear(&cloud);
}

static void columns_that_are_too_many(void **state)
{
	(void)state;
	gw_error error = { 0 };
	scan cloud = make_cloud(1, SCAN_FLOAT32);
	for (int i = 0; i < 342; i++) {
		char name[16];
		snprintf(name, sizeof name, "c%d", i);
		add(&cloud, name, SCAN_UINT8);
		/* A VLR has 65535 bytes, a description 192. */
		assert_int_equal(write_file(&cloud, &error), i < 341 ? GW_OK : GW_ERROR_DATA);
	}
	scan_clear(&cloud);
}

/* A field that cannot hold a value sends its column to the extra bytes or to a newer format. */
static void values_that_do_not_fit(void **state)
{
	(void)state;
	static uint8_t file[LAZ_SAMPLE_BYTES];
	scan cloud = read_bytes(file, laz_sample_plain(1, 0, file));
	((uint8_t *)scan_find(&cloud, "classification")->data)[3] = 64;
	scan back = write_and_read(&cloud);
	assert_true(value(&back, "classification", 3) == 64.0);
	/* Point 20 was seen at 1 degree, which is 166.7 steps of the newer format. */
	assert_true(value(&back, "scan_angle_rank", 20) == 1.0);
	assert_true(value(&back, "scan_angle", 20) == 167.0);
	scan_clear(&back);
	((uint8_t *)scan_find(&cloud, "return_number")->data)[3] = 16;
	back = write_and_read(&cloud);
	assert_true(value(&back, "return_number", 3) == 16.0);
	scan_clear(&back);
	scan_clear(&cloud);
}

/* -------------------------------------------------------------------------------- extra bytes */

/* A file of two points of format 0 with extra bytes, and room for VLRs. */
typedef struct file {
	uint8_t data[LAZ_SAMPLE_BYTES];
	size_t length;
} file;

static void start_file(file *f)
{
	f->length = laz_sample_plain(0, 0, f->data);
	f->length = load_32(f->data + 96);
}

static uint8_t *add_vlr(file *f, const char *user, uint16_t id, size_t length)
{
	uint8_t *v = f->data + f->length;
	memset(v, 0, 54 + length);
	memcpy(v + 2, user, strlen(user));
	store_16(v + 18, id);
	store_16(v + 20, (uint16_t)length);
	f->length += 54 + length;
	store_32(f->data + 96, (uint32_t)f->length);
	store_32(f->data + 100, load_32(f->data + 100) + 1);
	return v + 54;
}

static void add_points(file *f, const uint8_t *extra, size_t size)
{
	store_16(f->data + 105, (uint16_t)(20 + size));
	store_32(f->data + 107, 2);
	for (unsigned i = 0; i < 2; i++, f->length += 20 + size) {
		laz_sample_record(0, 0, i, f->data + f->length);
		memcpy(f->data + f->length + 20, extra + i * size, size);
	}
}

static void describe(uint8_t *to, uint8_t type, uint8_t options, const char *name)
{
	to[2] = type;
	to[3] = options;
	memcpy(to + 4, name, strlen(name));
}

/* All ten types, each -1 or its largest, then what is left over. */
static void extra_bytes_of_every_type(void **state)
{
	(void)state;
	static const double largest[10] = { 255, -1, 65535, -1, 4294967295.0, -1, 0, -1, 1.5, -2.25 };
	static file f;
	start_file(&f);
	uint8_t *v = add_vlr(&f, "LASF_Spec", 4, 10 * 192);
	for (uint8_t t = 0; t < 10; t++)
		describe(v + 192 * t, t + 1, 0, (char[]){ 't', (char)('0' + t), '\0' });
	uint8_t extra[2 * 44];
	memset(extra, 0xff, sizeof extra);
	for (size_t i = 0; i < 2; i++) {
		uint8_t *e = extra + 44 * i;
		store_64(e + 14, (uint64_t)1 << 53);
		store_32(e + 30, 0x3fc00000);
		store_double(e + 34, -2.25);
	}
	add_points(&f, extra, 44);
	scan cloud = read_bytes(f.data, f.length);
	for (int t = 0; t < 10; t++) {
		char name[3] = { 't', (char)('0' + t), '\0' };
		assert_true(value(&cloud, name, 1) == (t == 6 ? 0x1p53 : largest[t]));
	}
	assert_true(value(&cloud, "extra_0", 1) == 255.0 && value(&cloud, "extra_1", 1) == 255.0);
	scan back = write_and_read(&cloud);
	same_columns(&cloud, &back);
	scan_clear(&back);
	scan_clear(&cloud);
	/* One more than doubles count: two columns, and a note. */
	store_64(f.data + f.length - 44 + 14, ((uint64_t)1 << 53) + 1);
	cloud = read_bytes(f.data, f.length);
	assert_true(value(&cloud, "t6_low", 1) == 1.0);
	assert_true(value(&cloud, "t6_high", 1) == 0x1p21);
	assert_true(has_comment(&cloud, "note: the 64 bits of 't6'"));
	scan_clear(&cloud);
}

static void extra_bytes_with_scale_and_names(void **state)
{
	(void)state;
	static file f;
	start_file(&f);
	uint8_t *v = add_vlr(&f, "LASF_Spec", 4, 4 * 192);
	describe(v, 3, 8 | 16, "width");
	store_double(v + 112, 0.25);
	store_double(v + 136, -1.0);
	describe(v + 192, 12, 0, "pair");         /* two signed bytes */
	describe(v + 2 * 192, 1, 0, "intensity"); /* a field's name */
	describe(v + 3 * 192, 9, 0, "NormalX");
	uint8_t extra[2 * 9] = { 6, 0, 0xfe, 3, 77, 0, 0, 0x80, 0x3f, 0, 1, 0, 0, 5 };
	add_points(&f, extra, 9);
	scan cloud = read_bytes(f.data, f.length);
	assert_true(value(&cloud, "width", 0) == 0.5);
	assert_true(value(&cloud, "width", 1) == 63.0);
	assert_true(value(&cloud, "pair_0", 0) == -2.0 && value(&cloud, "pair_1", 0) == 3.0);
	assert_true(value(&cloud, "intensity", 0) >= 100.0);
	assert_true(value(&cloud, "intensity_2", 0) == 77.0);
	assert_true(value(&cloud, "nx", 0) == 1.0);
	scan_clear(&cloud);
	/* The description may claim more than there is. */
	v[192 + 2] = 30;
	cloud = read_bytes(f.data, f.length);
	assert_true(has_comment(&cloud, "note: the description of extra value 2 does not fit"));
	assert_true(value(&cloud, "width", 0) == 0.5 && value(&cloud, "extra_0", 0) == 254.0);
	scan_clear(&cloud);
}

/* A text record may name columns as it likes: what is empty does not count, what is taken gets a
 * number, and what is too long is cut. */
static void names_of_the_text_record(void **state)
{
	(void)state;
	static const char lines[] = "glowworm column one = \nglowworm column two = x\n"
								"glowworm column three = ";
	static file f;
	char name[256] = { 0 };
	start_file(&f);
	uint8_t *v = add_vlr(&f, "LASF_Spec", 4, 3 * 192);
	describe(v, 1, 0, "one");
	describe(v + 192, 1, 0, "two");
	describe(v + 2 * 192, 1, 0, "three");
	uint8_t *text = add_vlr(&f, "LASF_Spec", 3, sizeof lines + 1000);
	memset(text, '\t', sizeof lines + 1000); /* and no zero behind it */
	memcpy(text, lines, sizeof lines - 1);
	memset(name, '_', 240);
	uint8_t extra[2 * 3] = { 1, 2, 3, 4, 5, 6 };
	add_points(&f, extra, 3);
	scan cloud = read_bytes(f.data, f.length);
	assert_true(value(&cloud, "one", 1) == 4.0);
	assert_true(value(&cloud, "x_2", 1) == 5.0);
	assert_true(value(&cloud, name, 1) == 6.0);
	assert_false(has_comment(&cloud, "column"));
	scan_clear(&cloud);
}

/* ------------------------------------------------------------------------- coordinate systems */

static void coordinate_systems(void **state)
{
	(void)state;
	static file f;
	start_file(&f);
	enum { TEXT = 1900 };
	char text[TEXT + 1];
	for (int i = 0; i < TEXT; i++)
		text[i] = (char)(i % 100 == 99 || i % 801 == 800 ? ' ' : 'A' + i % 26);
	text[TEXT] = '\0';
	memcpy(add_vlr(&f, "LASF_Projection", 2112, TEXT + 1), text, TEXT);
	uint8_t *keys = add_vlr(&f, "LASF_Projection", 34735, 16);
	for (unsigned i = 0; i < 8; i++)
		store_16(keys + 2 * i, (uint16_t)(1 + i * 5000));
	store_double(add_vlr(&f, "LASF_Projection", 34736, 8), 0.1);
	memcpy(add_vlr(&f, "LASF_Projection", 34737, 5), "UTM|", 4);
	memcpy(add_vlr(&f, "LASF_Spec", 3, 12), "one\n\ntwo \n", 10);
	add_points(&f, f.data, 0);
	scan cloud = read_bytes(f.data, f.length), back = write_and_read(&cloud);
	assert_true(has_comment(&cloud, "las geokeys 1 5001 10001 15001 20001 25001 30001 35001"));
	assert_true(has_comment(&cloud, "las geodoubles 0.1"));
	assert_true(has_comment(&cloud, "las geotext UTM|"));
	assert_true(has_comment(&cloud, "one") && has_comment(&cloud, "two"));
	for (size_t c = 0; c < cloud.comment_count; c++) {
		assert_true(strlen(cloud.comment[c]) < 1000);
		/* The bounds are right now, and the system is said to be WKT. */
		bool changed = strncmp(cloud.comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0 ||
					   strncmp(cloud.comment[c], "las file", 8) == 0;
		if (!changed && !has_comment(&back, cloud.comment[c]))
			fail_msg("'%s' is lost", cloud.comment[c]);
	}
	scan_clear(&cloud);
	scan_clear(&back);

	static uint8_t written[2 * LAZ_SAMPLE_BYTES];
	FILE *stream = fopen(path, "rb");
	size_t got = fread(written, 1, sizeof written, stream);
	fclose(stream);
	assert_non_null(memmem(written, got, text, TEXT + 1));
	assert_non_null(memmem(written, got, keys, 16));
}

/* -------------------------------------------------------------------------- headers that lie */

static void colors_and_bounds(void **state)
{
	(void)state;
	static uint8_t data[LAZ_SAMPLE_BYTES];
	size_t length = laz_sample_plain(2, 0, data), points = load_32(data + 96);
	scan cloud = read_bytes(data, length);
	assert_int_equal(scan_find(&cloud, "red")->type, SCAN_UINT16);
	/* The samples' headers leave the bounds at zero. */
	assert_true(has_comment(&cloud, "note: the header's bounds are wrong by up to "));
	scan_clear(&cloud);
	for (size_t i = 0; i < LAZ_SAMPLE_POINTS; i++)
		memset(data + points + 26 * i + 20, 0, 6);
	cloud = read_bytes(data, length);
	assert_null(scan_find(&cloud, "red"));
	assert_true(has_comment(&cloud, "note: all colours are zero"));
	scan_clear(&cloud);
	data[points + 26 * 7 + 22] = 1;
	cloud = read_bytes(data, length);
	assert_true(value(&cloud, "green", 7) == 1.0 && value(&cloud, "red", 7) == 0.0);
	scan_clear(&cloud);
}

static void refused(const uint8_t *data, size_t length, const char *because)
{
	input_file in = { .name = "sample.las", .data = data, .length = length };
	scan cloud;
	gw_error error = { 0 };
	assert_int_equal(las_read(&in, &cloud, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "sample.las"));
	if (!strstr(error.text, because))
		fail_msg("'%s' does not say '%s'", error.text, because);
}

static void counts_and_sizes(void **state)
{
	(void)state;
	static uint8_t data[LAZ_SAMPLE_BYTES];
	size_t length = laz_sample_plain(6, 0, data);
	store_32(data + 107, 12); /* the old count, which the one of 64 bits overrules */
	scan cloud = read_bytes(data, length);
	assert_int_equal(cloud.count, LAZ_SAMPLE_POINTS);
	assert_true(has_comment(&cloud, "counts 30 points in 64 bits and 12 in 32"));
	scan_clear(&cloud);
	store_64(data + 247, 0); /* or which is the only one */
	cloud = read_bytes(data, length);
	assert_int_equal(cloud.count, 12);
	scan_clear(&cloud);
	store_64(data + 247, (uint64_t)1 << 61);
	refused(data, length, "counts 2305843009213693952 points");
	store_64(data + 247, LAZ_SAMPLE_POINTS);
	refused(data, length - 1, "room for 29");
	data[25] = 6;
	refused(data, length, "version 1.6");
	data[25] = 4;
	data[104] = 11;
	refused(data, length, "format 11");
	data[104] = 6;
	store_16(data + 105, 29);
	refused(data, length, "points of 29 bytes, but those of format 6 take 30");
	store_16(data + 105, 30);
	store_double(data + 131, 0.0);
	refused(data, length, "byte 131");
	store_double(data + 131, 0.001);
	store_double(data + 163, NAN);
	refused(data, length, "byte 163");
	store_double(data + 163, 0.0);
	store_32(data + 96, 374);
	refused(data, length, "shall begin at byte 374");
	store_32(data + 96, 375);
	store_32(data + 100, UINT32_MAX);
	cloud = read_bytes(data, length);
	assert_true(has_comment(&cloud, "counts 4294967295 variable-length records, of which 0"));
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_point_format),
		cmocka_unit_test(header_says_what_is),
		cmocka_unit_test(decimal_grids),
		cmocka_unit_test(rounded_grids),
		cmocka_unit_test(grids_of_a_step),
		cmocka_unit_test(coordinates_that_are_refused),
		cmocka_unit_test(lit_points),
		cmocka_unit_test(columns_that_are_too_many),
		cmocka_unit_test(values_that_do_not_fit),
		cmocka_unit_test(extra_bytes_of_every_type),
		cmocka_unit_test(extra_bytes_with_scale_and_names),
		cmocka_unit_test(names_of_the_text_record),
		cmocka_unit_test(coordinate_systems),
		cmocka_unit_test(colors_and_bounds),
		cmocka_unit_test(counts_and_sizes),
	};
	return cmocka_run_group_tests(tests, make_path, remove_path);
}
