#include "pictures/exr_picture.h"

#include <OpenEXR/openexr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A little larger than at the default level, and written in half the time. */
#define ZIP_LEVEL 2

/* The file as it grows in memory. */
typedef struct sink {
	uint8_t *bytes;
	uint64_t size, room;
	bool full;         /* memory is short */
	char message[256]; /* what OpenEXRCore said first */
} sink;

static int64_t write_bytes(exr_const_context_t context, void *user, const void *bytes,
						   uint64_t length, uint64_t offset, exr_stream_error_func_ptr_t failed)
{
	sink *s = user;
	uint64_t end;
	if (__builtin_add_overflow(offset, length, &end) || end > INT64_MAX / 2) {
		s->full = true;
	} else if (end > s->room) {
		uint64_t room = end > s->room * 2 ? end : s->room * 2;
		uint8_t *grown = realloc(s->bytes, room);
		s->full = grown == NULL;
		if (grown) {
			s->bytes = grown;
			s->room = room;
		}
	}
	if (s->full) {
		failed(context, EXR_ERR_OUT_OF_MEMORY, "no memory for the file");
		return -1;
	}
	if (offset > s->size)
		memset(s->bytes + s->size, 0, offset - s->size);
	memcpy(s->bytes + offset, bytes, length);
	s->size = end > s->size ? end : s->size;
	return (int64_t)length;
}

/* Nothing to close. It has to be there, or the library would remove the file by its name. */
static void destroy_stream(exr_const_context_t context, void *user, int failed)
{
	(void)context;
	(void)user;
	(void)failed;
}

/* The picture that this thread is writing. A context that reports an error is locked, so it cannot
 * be asked for its user data. */
static _Thread_local sink *writing;

static void on_error(exr_const_context_t context, exr_result_t code, const char *message)
{
	(void)context;
	(void)code;
	if (writing && !writing->message[0])
		snprintf(writing->message, sizeof writing->message, "%s", message);
}

static exr_result_t put_header(exr_context_t file, const exr_picture *p)
{
	int part = 0;
	exr_attr_chromaticities_t rec709 = {
		0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f
	};
	exr_result_t result = exr_add_part(file, "picture", EXR_STORAGE_SCANLINE, &part);
	if (result == EXR_ERR_SUCCESS)
		result = exr_initialize_required_attr_simple(file, part, (int32_t)p->width,
													 (int32_t)p->height, EXR_COMPRESSION_ZIP);
	if (result == EXR_ERR_SUCCESS)
		result = exr_attr_set_chromaticities(file, part, "chromaticities", &rec709);
	for (size_t i = 0; i < p->text_count && result == EXR_ERR_SUCCESS; i++)
		result = exr_attr_set_string(file, part, p->text[i].name, p->text[i].text);
	for (size_t i = 0; i < p->channel_count && result == EXR_ERR_SUCCESS; i++)
		result = exr_add_channel(file, part, p->channel[i].name,
								 p->channel[i].whole ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT,
								 EXR_PERCEPTUALLY_LINEAR, 1, 1);
	return result == EXR_ERR_SUCCESS ? exr_write_header(file) : result;
}

/* OpenEXRCore sorts the channels, so each is found by its name. */
static void point_to_rows(const exr_picture *p, uint32_t row, exr_encode_pipeline_t *encoder)
{
	for (int16_t c = 0; c < encoder->channel_count; c++) {
		exr_coding_channel_info_t *coded = encoder->channels + c;
		for (size_t i = 0; i < p->channel_count; i++) {
			const exr_channel *from = p->channel + i;
			if (strcmp(from->name, coded->channel_name) != 0)
				continue;
			coded->user_pixel_stride = (int32_t)(from->stride * 4);
			coded->user_line_stride = (int32_t)(from->stride * 4 * p->width);
			coded->user_bytes_per_element = 4;
			coded->user_data_type = from->whole ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
			coded->encode_from_ptr =
				(const uint8_t *)from->values + from->stride * 4 * p->width * row;
		}
	}
}

static exr_result_t put_rows(exr_context_t file, const exr_picture *p)
{
	exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
	exr_chunk_info_t chunk;
	int32_t lines = 1;
	bool begun = false;
	exr_result_t result = exr_get_scanlines_per_chunk(file, 0, &lines);
	for (uint32_t y = 0; y < p->height && result == EXR_ERR_SUCCESS; y += (uint32_t)lines) {
		result = exr_write_scanline_chunk_info(file, 0, (int)y, &chunk);
		if (result != EXR_ERR_SUCCESS)
			break;
		result = begun ? exr_encoding_update(file, 0, &chunk, &encoder)
					   : exr_encoding_initialize(file, 0, &chunk, &encoder);
		if (result != EXR_ERR_SUCCESS)
			break;
		point_to_rows(p, y, &encoder);
		if (!begun)
			result = exr_encoding_choose_default_routines(file, 0, &encoder);
		begun = true;
		if (result == EXR_ERR_SUCCESS)
			result = exr_encoding_run(file, 0, &encoder);
	}
	if (begun)
		exr_encoding_destroy(file, &encoder);
	return result;
}

gw_status exr_picture_write(output_file *out, const exr_picture *picture, gw_error *error)
{
	sink s = { .bytes = NULL };
	exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
	start.error_handler_fn = on_error;
	start.user_data = &s;
	start.write_fn = write_bytes;
	start.destroy_fn = destroy_stream;
	start.zip_level = ZIP_LEVEL;
	exr_context_t file = NULL;
	writing = &s;
	exr_result_t result =
		exr_start_write(&file, output_file_name(out), EXR_WRITE_FILE_DIRECTLY, &start);
	if (result == EXR_ERR_SUCCESS)
		result = put_header(file, picture);
	if (result == EXR_ERR_SUCCESS)
		result = put_rows(file, picture);
	/* It reports success after failures, so the first result counts. */
	exr_result_t finished = file ? exr_finish(&file) : EXR_ERR_SUCCESS;
	result = result == EXR_ERR_SUCCESS ? finished : result;
	writing = NULL;
	gw_status status;
	if (s.full || result == EXR_ERR_OUT_OF_MEMORY)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	else if (result != EXR_ERR_SUCCESS)
		status = gw_fail(error, GW_ERROR_INTERNAL, "%s cannot be written as EXR: %s",
						 output_file_name(out),
						 s.message[0] ? s.message : exr_get_default_error_message(result));
	else
		status = output_file_write(out, s.bytes, s.size, error);
	free(s.bytes);
	return status;
}
