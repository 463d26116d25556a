/* PNG and EXR files read back, cameras from text, and the scale of false colours. */
#include "options/camera_text.h"
#include "pictures/exr_picture.h"
#include "pictures/false_color.h"
#include "pictures/isolux.h"
#include "pictures/png_picture.h"

#include <OpenEXR/openexr.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char *const path = "test_pictures.tmp";

static output_file *create(void)
{
	output_file *out = NULL;
	assert_int_equal(output_file_create(&out, path, true, NULL), GW_OK);
	return out;
}

/* Every byte comes back, of opaque and of transparent pictures. */
static void test_png(void **state)
{
	(void)state;
	for (size_t channels = 3; channels <= 4; channels++) {
		uint8_t pixels[7 * 5 * 4], back[sizeof pixels];
		for (size_t i = 0; i < sizeof pixels; i++)
			pixels[i] = (uint8_t)(i * 37);
		const png_picture_text text[1] = { { "Software", "a test" } };
		png_picture picture = { 7, 5, channels == 4, pixels, text, 1 };
		output_file *out = create();
		assert_int_equal(png_picture_write(out, &picture, NULL), GW_OK);
		assert_int_equal(output_file_commit(&out, NULL), GW_OK);
		png_image image = { .version = PNG_IMAGE_VERSION };
		assert_true(png_image_begin_read_from_file(&image, path));
		assert_int_equal(image.width, 7);
		assert_int_equal(image.height, 5);
		image.format = channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
		assert_true(png_image_finish_read(&image, NULL, back, 0, NULL));
		assert_memory_equal(back, pixels, 7 * 5 * channels);
	}
	unlink(path);
}

/* Reads one channel of an EXR file of one part. */
static void read_channel(const char *name, uint32_t width, uint32_t height, void *values)
{
	exr_context_t file = NULL;
	exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
	int32_t lines;
	bool begun = false, found = false;
	exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
	assert_int_equal(exr_start_read(&file, path, &start), EXR_ERR_SUCCESS);
	exr_get_scanlines_per_chunk(file, 0, &lines);
	for (uint32_t y = 0; y < height; y += (uint32_t)lines) {
		exr_chunk_info_t chunk;
		assert_int_equal(exr_read_scanline_chunk_info(file, 0, (int)y, &chunk), EXR_ERR_SUCCESS);
		if (begun)
			exr_decoding_update(file, 0, &chunk, &decoder);
		else
			exr_decoding_initialize(file, 0, &chunk, &decoder);
		for (int c = 0; c < decoder.channel_count; c++) {
			exr_coding_channel_info_t *channel = decoder.channels + c;
			bool it = strcmp(channel->channel_name, name) == 0;
			found |= it;
			channel->decode_to_ptr = it ? (uint8_t *)values + 4u * width * y : NULL;
			channel->user_pixel_stride = 4;
			channel->user_line_stride = (int32_t)(4 * width);
			channel->user_bytes_per_element = 4;
			channel->user_data_type = channel->data_type;
		}
		if (!begun)
			exr_decoding_choose_default_routines(file, 0, &decoder);
		begun = true;
		assert_int_equal(exr_decoding_run(file, 0, &decoder), EXR_ERR_SUCCESS);
	}
	exr_decoding_destroy(file, &decoder);
	exr_finish(&file);
	assert_true(found);
}

/* Every float and integer comes back bit for bit, also infinity, over several chunks of lines. */
static void test_exr(void **state)
{
	(void)state;
	enum { WIDTH = 13, HEIGHT = 37, PIXELS = WIDTH * HEIGHT };
	float values[2 * PIXELS], back[PIXELS];
	uint32_t ids[PIXELS], ids_back[PIXELS];
	for (int i = 0; i < PIXELS; i++) {
		values[2 * i] = (float)i * 0.37f;
		values[2 * i + 1] = i % 5 ? -(float)i : INFINITY;
		ids[i] = 0xffffffffu - (uint32_t)i;
	}
	const exr_channel channel[] = { { "Z", false, values + 1, 2 },
									{ "direct.R", false, values, 2 },
									{ "id", true, ids, 1 } };
	const exr_text text[] = { { "comments", "a test" } };
	exr_picture picture = { WIDTH, HEIGHT, channel, 3, text, 1 };
	output_file *out = create();
	assert_int_equal(exr_picture_write(out, &picture, NULL), GW_OK);
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	read_channel("direct.R", WIDTH, HEIGHT, back);
	for (int i = 0; i < PIXELS; i++)
		assert_memory_equal(&back[i], &values[2 * i], sizeof(float));
	read_channel("Z", WIDTH, HEIGHT, back);
	for (int i = 0; i < PIXELS; i++)
		assert_memory_equal(&back[i], &values[2 * i + 1], sizeof(float));
	read_channel("id", WIDTH, HEIGHT, ids_back);
	assert_memory_equal(ids_back, ids, sizeof ids);
	unlink(path);
}

/* Two channels of one name cannot be: the sentence says so, and nothing is left behind. */
static void test_exr_refusal(void **state)
{
	(void)state;
	float value = 1;
	const exr_channel channel[] = { { "R", false, &value, 1 }, { "R", false, &value, 1 } };
	exr_picture picture = { 1, 1, channel, 2, NULL, 0 };
	gw_error error = { 0 };
	output_file *out = create();
	assert_int_equal(exr_picture_write(out, &picture, &error), GW_ERROR_INTERNAL);
	assert_non_null(strstr(error.text, "cannot be written as EXR"));
	output_file_abandon(&out);
	assert_int_not_equal(access(path, F_OK), 0);
}

/* A full disk is the output's own message. */
static void test_full_disk(void **state)
{
	(void)state;
	enum { SIDE = 600 };
	output_file *out = NULL;
	gw_error error = { 0 };
	uint8_t *noise = malloc(SIDE * SIDE * 3);
	float *values = malloc(SIDE * SIDE * sizeof *values);
	uint32_t random = 1;
	for (size_t i = 0; i < SIDE * SIDE * 3; i++) {
		random = random * 1664525u + 1013904223u;
		noise[i] = (uint8_t)(random >> 24);
		values[i / 3] = (float)random;
	}
	png_picture picture = { SIDE, SIDE, false, noise, NULL, 0 };
	assert_int_equal(output_file_create(&out, "/dev/full", true, NULL), GW_OK);
	assert_int_equal(png_picture_write(out, &picture, &error), FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "/dev/full"));
	output_file_abandon(&out);
	const exr_channel channel[] = { { "Y", false, values, 1 } };
	exr_picture numbers = { SIDE, SIDE, channel, 1, NULL, 0 };
	assert_int_equal(output_file_create(&out, "/dev/full", true, NULL), GW_OK);
	assert_int_equal(exr_picture_write(out, &numbers, &error), FILE_ERROR_IO);
	output_file_abandon(&out);
	free(noise);
	free(values);
}

/* ----------------------------------------------------------------------- cameras from text */

static void expect_camera_error(const char *text, const char *word)
{
	camera_text c;
	gw_error error = { 0 };
	assert_int_equal(camera_text_read("--camera", text, &c, &error), GW_ERROR_USAGE);
	if (!strstr(error.text, word))
		fail_msg("'%s' does not say '%s'", error.text, word);
}

static void test_camera_text(void **state)
{
	(void)state;
	camera_text c;
	assert_int_equal(camera_text_read("--camera", " to 4,5,6  fov 30.5 at 1,2,-3e2", &c, NULL),
					 GW_OK);
	assert_true(c.placed && c.at[2] == -300 && c.to[1] == 5 && c.angle == 30.5);
	assert_int_equal(camera_text_read("--camera", "inside fov 90", &c, NULL), GW_OK);
	assert_true(!c.placed && c.kind == GW_VIEWPOINT_INSIDE && c.angle == 90);
	assert_int_equal(camera_text_read("--camera", "fov 20", &c, NULL), GW_OK);
	assert_true(!c.placed && c.kind == GW_VIEWPOINT_AUTO && c.angle == 20);
	expect_camera_error("", "both 'at' and 'to'");
	expect_camera_error("at 1,2,3", "both 'at' and 'to'");
	expect_camera_error("inside at 1,2,3 to 4,5,6", "both 'at' and 'to'");
	expect_camera_error("at 1,2 to 4,5,6", "three numbers");
	expect_camera_error("at 1,2,nan to 4,5,6", "three numbers");
	expect_camera_error("at 1,2,3 to 4,5,6 fov 0", "above 0");
	expect_camera_error("at 1,2,3 to 4,5,6 fov 180", "above 0");
	expect_camera_error("at 1,2,3 at 1,2,3", "before");
	expect_camera_error("insid", "inside");
}

/* ---------------------------------------------------------------------------- false colours */

/* The ends of a range, and its middle on a logarithmic one: stops 3 and 4 of 7, half way. */
static void test_colors(void **state)
{
	(void)state;
	false_color_range range = { 0.01, 1, true, "" };
	uint8_t low[3], middle[3], high[3];
	false_color_of(&range, 0, low);
	false_color_of(&range, 0.1, middle);
	false_color_of(&range, 5, high);
	assert_int_equal(low[0] + low[1] + low[2], 0);
	assert_int_equal(high[0] + high[1] + high[2], 3 * 249);
	/* The middle of the logarithms. */
	false_color_range linear = { 0, 2, false, "" };
	uint8_t same[3];
	false_color_of(&linear, 1, same);
	assert_memory_equal(middle, same, 3);
}

static double linear_of(uint8_t code)
{
	double v = code / 255.0;
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double lab_root(double t)
{
	return t > 216.0 / 24389.0 ? cbrt(t) : t * 841.0 / 108.0 + 4.0 / 29.0;
}

/* CIELAB of a colour of the screen, white being D65. */
static void lab_of(const uint8_t rgb[3], double lab[3])
{
	double r = linear_of(rgb[0]), g = linear_of(rgb[1]), b = linear_of(rgb[2]);
	double x = lab_root((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
	double y = lab_root(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
	double z = lab_root((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
	lab[0] = 116.0 * y - 16.0;
	lab[1] = 500.0 * (x - y);
	lab[2] = 200.0 * (y - z);
}

/* Equal steps of a value look alike: 32 of them differ by 7 to 9 in CIELAB, of which rounding to 8
 * bits is up to 0.7; and all become lighter. */
static void test_even_colors(void **state)
{
	(void)state;
	const false_color_range range = { 0, 32, false, "" };
	double before[3] = { 0 }, least = INFINITY, most = 0.0;
	for (int i = 0; i <= 32; i++) {
		uint8_t rgb[3];
		double lab[3], square = 0.0;
		false_color_of(&range, i, rgb);
		lab_of(rgb, lab);
		for (int k = 0; k < 3; k++)
			square += (lab[k] - before[k]) * (lab[k] - before[k]);
		assert_true(i == 0 || lab[0] > before[0] + 1.0);
		least = i == 0 ? least : fmin(least, sqrt(square));
		most = fmax(most, sqrt(square));
		memcpy(before, lab, sizeof before);
	}
	if (!(most <= 1.25 * least))
		fail_msg("steps are %g to %g", least, most);
}

static void test_range_text(void **state)
{
	(void)state;
	static const char *const bad[] = { "",      "5",     "5,",      "0,500,",   "500,0", "1,1",
									   "0,9,x", "0,nan", "0,9,log", "0,9,log ", "a,b",   "1,inf" };
	false_color_range range;
	isolux lines;
	assert_int_equal(false_color_read("0,500", &range, NULL), GW_OK);
	assert_true(range.low == 0 && range.high == 500 && !range.logarithmic);
	assert_int_equal(false_color_read("0.1,5e2,log", &range, NULL), GW_OK);
	assert_true(range.low == 0.1 && range.high == 500 && range.logarithmic);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		if (false_color_read(bad[i], &range, NULL) != GW_ERROR_USAGE)
			fail_msg("'%s' was taken", bad[i]);
	static const char *const no_list[] = {
		"",   "0",  "-1",   "5,5", "5,4",
		"1,", ",1", "1,,2", "x",   "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17"
	};
	for (size_t i = 0; i < sizeof no_list / sizeof *no_list; i++)
		if (isolux_read(no_list[i], &lines, NULL) != GW_ERROR_USAGE)
			fail_msg("'%s' was taken", no_list[i]);
	assert_int_equal(isolux_read("50,100,200", &lines, NULL), GW_OK);
	assert_true(lines.count == 3 && lines.level[1] == 100);
}

#define SIDE 40u

/* A line is where the value passes its level, nowhere else; not where one thing hides another. */
static void test_isolux(void **state)
{
	(void)state;
	float values[3 * SIDE * SIDE], depth[SIDE * SIDE], coverage[SIDE * SIDE];
	uint8_t pixels[3 * SIDE * SIDE];
	const gw_gbuffer g = { .width = SIDE, .height = SIDE, .depth = depth, .coverage = coverage };
	const canvas c = { pixels, SIDE, SIDE, 3, 1 };
	for (size_t i = 0; i < SIDE * SIDE; i++) {
		/* Along x, in two steps of depth along y, of which the farther is twice as bright. */
		bool far = i / SIDE >= SIDE / 2;
		values[3 * i] = (float)(i % SIDE + 1) * (far ? 2.0f : 1.0f);
		depth[i] = far ? 5.0f : 1.0f;
		coverage[i] = 1.0f;
	}
	memset(pixels, 200, sizeof pixels);
	isolux lines = { { 20.5 }, 1 };
	assert_int_equal(isolux_draw(&lines, &g, values, &c, NULL), GW_OK);
	for (size_t i = 0; i < SIDE * SIDE; i++) {
		size_t x = i % SIDE, y = i / SIDE;
		bool line = x == (y >= SIDE / 2 ? 9u : 19u);
		bool label = x > 3 && x < 29 && y > 10 && y < 30;
		if (!label && (pixels[3 * i] == 0) != line)
			fail_msg("%zu,%zu is %d", x, y, pixels[3 * i]);
	}
}

static void test_fit(void **state)
{
	(void)state;
	float values[1000];
	for (int i = 0; i < 1000; i++)
		values[i] = (float)i;
	values[7] = NAN;
	false_color_range linear = false_color_fit(values, 1000, false);
	assert_true(linear.low == 0 && linear.high == 999);
	for (int i = 0; i < 1000; i++)
		values[i] = (float)i;
	/* 999 values above 0: rank 999 / 100 = 9 is 10, and three powers of ten are more than that. */
	false_color_range logarithmic = false_color_fit(values, 1000, true);
	assert_true(logarithmic.low == 10 && logarithmic.high == 999);
	float same[3] = { 4, 4, 4 };
	false_color_range one = false_color_fit(same, 3, true);
	assert_true(one.low == 4 && one.high == 8);
	false_color_range none = false_color_fit(same, 0, false);
	assert_true(none.low < none.high);
}

/* The scale stays within the picture, whatever its size; small ones are left alone. */
static void test_scale(void **state)
{
	(void)state;
	const false_color_range range = { 3e-9, 2e6, true, "W/(sr m^2)" };
	for (uint32_t width = 1; width < 400; width += 133) {
		size_t bytes = (size_t)width * 150 * 4;
		uint8_t *pixels = calloc(bytes + 2, 1);
		false_color_draw_scale(&range, pixels + 1, width, 150, 4);
		assert_int_equal(pixels[0] + pixels[bytes + 1], 0);
		bool drawn = false;
		for (size_t i = 0; i < bytes; i++)
			drawn |= pixels[i + 1] != 0;
		assert_true(drawn == (width >= 160));
		free(pixels);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_png),         cmocka_unit_test(test_exr),
		cmocka_unit_test(test_exr_refusal), cmocka_unit_test(test_full_disk),
		cmocka_unit_test(test_camera_text), cmocka_unit_test(test_colors),
		cmocka_unit_test(test_even_colors), cmocka_unit_test(test_range_text),
		cmocka_unit_test(test_isolux),      cmocka_unit_test(test_fit),
		cmocka_unit_test(test_scale),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
