#include "pictures/png_picture.h"

#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#define TEXTS 8

typedef struct writer {
	output_file *out;
	gw_error *error;
	gw_status status;
} writer;

static void write_bytes(png_structp png, png_bytep bytes, size_t length)
{
	writer *w = png_get_io_ptr(png);
	w->status = output_file_write(w->out, bytes, length, w->error);
	if (w->status != GW_OK)
		png_error(png, "the output failed");
}

static void flush_bytes(png_structp png)
{
	(void)png;
}

/* What the output said goes before what libpng says of it. */
static void on_error(png_structp png, png_const_charp message)
{
	writer *w = png_get_error_ptr(png);
	if (w->status == GW_OK)
		w->status = gw_fail(w->error, GW_ERROR_INTERNAL, "%s cannot be written as PNG: %s",
							output_file_name(w->out), message);
	longjmp(png_jmpbuf(png), 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
	(void)png;
	(void)message;
}

static void put_text(png_structp png, png_infop info, const png_picture *image)
{
	png_textp text = png_calloc(png, TEXTS * sizeof *text);
	size_t count = image->text_count < TEXTS ? image->text_count : TEXTS;
	for (size_t i = 0; i < count; i++) {
		text[i].compression = PNG_TEXT_COMPRESSION_NONE;
		/* libpng takes pointers to data that it does not change. */
		memcpy(&text[i].key, &image->text[i].key, sizeof text[i].key);
		memcpy(&text[i].text, &image->text[i].text, sizeof text[i].text);
	}
	png_set_text(png, info, text, (int)count);
	png_free(png, text);
}

/* Ends by longjmp when something fails. */
static void put_image(png_structp png, png_infop info, const png_picture *image)
{
	size_t row = (size_t)image->width * (image->alpha ? 4u : 3u);
	png_set_IHDR(png, info, image->width, image->height, 8,
				 image->alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
				 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
	put_text(png, info, image);
	/* The level that is half as large as none and a quarter of the default's time. */
	png_set_compression_level(png, 3);
	png_write_info(png, info);
	for (uint32_t y = 0; y < image->height; y++)
		png_write_row(png, image->pixels + y * row);
	png_write_end(png, info);
}

gw_status png_picture_write(output_file *out, const png_picture *image, gw_error *error)
{
	writer w = { out, error, GW_OK };
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, on_error, on_warning);
	png_infop info = png ? png_create_info_struct(png) : NULL;
	if (!info) {
		png_destroy_write_struct(&png, NULL);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	}
	if (setjmp(png_jmpbuf(png)) == 0) {
		png_set_write_fn(png, &w, write_bytes, flush_bytes);
		put_image(png, info, image);
	}
	png_destroy_write_struct(&png, &info);
	return w.status;
}
