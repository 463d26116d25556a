/* PNG and EXR files read back, cameras from text, and the scale of false colours. */
#include "options/camera_text.h"
#include "pictures/exr_picture.h"
#include "pictures/false_color.h"
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
	assert_int_equal(png_picture_write(out, &picture, &error), GW_ERROR_IO);
	assert_non_null(strstr(error.text, "/dev/full"));
	output_file_abandon(&out);
	const exr_channel channel[] = { { "Y", false, values, 1 } };
	exr_picture numbers = { SIDE, SIDE, channel, 1, NULL, 0 };
	assert_int_equal(output_file_create(&out, "/dev/full", true, NULL), GW_OK);
	assert_int_equal(exr_picture_write(out, &numbers, &error), GW_ERROR_IO);
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
	assert_int_equal(high[0] + high[1] + high[2], 3 * 255);
	assert_int_equal(middle[0], (190 + 240) / 2);
	assert_int_equal(middle[1], (45 + 105) / 2);
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
		cmocka_unit_test(test_fit),         cmocka_unit_test(test_scale),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
