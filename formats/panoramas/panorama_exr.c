/*
 * OpenEXR pictures: the channels R, G and B, or Y alone, of the first part.
 */
#include "panoramas/panorama.h"

#include <OpenEXR/openexr.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Pixels that a byte may stand for at most. ZIP reaches a thousand bytes a byte; PIZ and DWA more
 * on rows of one colour. */
#define PIXELS_A_BYTE 4096

typedef struct source {
	const input_file *in;
	char message[256]; /* what OpenEXRCore said first */
} source;

static int64_t give_size(exr_const_context_t context, void *user)
{
	(void)context;
	return (int64_t)((source *)user)->in->length;
}

/* The library also reads ahead, so what is not there is no failure here. */
static int64_t give_bytes(exr_const_context_t context, void *user, void *buffer, uint64_t size,
						  uint64_t offset, exr_stream_error_func_ptr_t fail)
{
	const input_file *in = ((source *)user)->in;
	(void)context;
	(void)fail;
	if (offset >= in->length)
		return 0;
	if (size > in->length - offset)
		size = in->length - offset;
	memcpy(buffer, in->data + offset, size);
	return (int64_t)size;
}

/* The picture that this thread is reading; see exr_picture.c. */
static _Thread_local source *reading;

static void on_error(exr_const_context_t context, exr_result_t code, const char *message)
{
	(void)context;
	(void)code;
	if (reading && !reading->message[0])
		snprintf(reading->message, sizeof reading->message, "%s", message);
}

static gw_status bad(const source *s, const char *what, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA, "%s: %s", s->in->name, what);
}

static gw_status failed(const source *s, exr_result_t result, gw_error *error)
{
	if (result == EXR_ERR_OUT_OF_MEMORY)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to read %s", s->in->name);
	return gw_fail(error, GW_ERROR_DATA, "%s cannot be read as EXR: %s", s->in->name,
				   s->message[0] ? s->message : exr_get_default_error_message(result));
}

/* Which of red, green and blue a channel is; 3: all of them; -1: none. */
static int channel_of(const char *name)
{
	static const char *const names[] = { "R", "G", "B", "Y" };
	for (int c = 0; c < 4; c++)
		if (strcmp(name, names[c]) == 0)
			return c;
	return -1;
}

/* The picture has to be one that the rest can take. rgb: it has red, green and blue, not grey. */
static gw_status check_channels(const source *s, exr_const_context_t file, bool *rgb,
								gw_error *error)
{
	const exr_attr_chlist_t *channels;
	exr_storage_t storage;
	unsigned found = 0;
	if (exr_get_storage(file, 0, &storage) != EXR_ERR_SUCCESS ||
		(storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED))
		return bad(s, "its first part is deep; a map has one colour in each direction", error);
	exr_result_t result = exr_get_channels(file, 0, &channels);
	if (result != EXR_ERR_SUCCESS)
		return failed(s, result, error);
	for (int i = 0; i < channels->num_channels; i++) {
		const exr_attr_chlist_entry_t *entry = &channels->entries[i];
		int c = channel_of(entry->name.str);
		if (entry->x_sampling != 1 || entry->y_sampling != 1)
			return bad(s, "a channel has fewer pixels than the picture", error);
		if (c >= 0 && entry->pixel_type == EXR_PIXEL_UINT)
			return bad(s, "its colours are whole numbers, not light", error);
		found |= c >= 0 ? 1u << c : 0;
	}
	*rgb = (found & 7u) == 7u;
	return *rgb || found & 8u ? GW_OK : bad(s, "it has neither R, G and B nor Y", error);
}

/* OpenEXRCore knows the name of this compression, but does not decode it. */
static bool is_dwa(exr_const_context_t file)
{
	exr_compression_t compression;
	return exr_get_compression(file, 0, &compression) == EXR_ERR_SUCCESS &&
		   (compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB);
}

static gw_status take_header(const source *s, exr_const_context_t file, panorama *map, bool *rgb,
							 gw_error *error)
{
	exr_attr_box2i_t data, shown;
	exr_result_t result = exr_get_data_window(file, 0, &data);
	if (result == EXR_ERR_SUCCESS)
		result = exr_get_display_window(file, 0, &shown);
	if (result != EXR_ERR_SUCCESS)
		return failed(s, result, error);
	if (memcmp(&data, &shown, sizeof data) != 0)
		return bad(s, "its pixels are cut out of a larger picture; a map holds all directions",
				   error);
	GW_TRY(check_channels(s, file, rgb, error));
	int64_t width = (int64_t)data.max.x - data.min.x + 1;
	int64_t height = (int64_t)data.max.y - data.min.y + 1;
	uint64_t most = (uint64_t)s->in->length * PIXELS_A_BYTE;
	return panorama_allocate(s->in, width > 0 ? (uint64_t)width : 0,
							 height > 0 ? (uint64_t)height : 0, most, map, error);
}

/* What is being decoded, chunk by chunk. */
typedef struct decoding {
	exr_const_context_t file;
	panorama *map;
	bool rgb;
	exr_decode_pipeline_t pipeline;
	bool begun;
} decoding;

/* Leads the channels to pixel (x, y) of the map. */
static void point_to_pixels(decoding *d, uint32_t x, uint32_t y)
{
	for (int16_t i = 0; i < d->pipeline.channel_count; i++) {
		exr_coding_channel_info_t *to = d->pipeline.channels + i;
		int c = channel_of(to->channel_name);
		bool wanted = d->rgb ? c >= 0 && c < 3 : c == 3;
		float *pixel = d->map->pixels + 3 * ((size_t)d->map->width * y + x);
		to->decode_to_ptr = wanted ? (uint8_t *)(pixel + (d->rgb ? c : 0)) : NULL;
		to->user_pixel_stride = 12;
		to->user_line_stride = (int32_t)(12 * d->map->width);
		to->user_bytes_per_element = 4;
		to->user_data_type = EXR_PIXEL_FLOAT;
	}
}

static exr_result_t take_chunk(decoding *d, const exr_chunk_info_t *chunk, uint32_t x, uint32_t y)
{
	exr_result_t result = d->begun ? exr_decoding_update(d->file, 0, chunk, &d->pipeline)
								   : exr_decoding_initialize(d->file, 0, chunk, &d->pipeline);
	if (result != EXR_ERR_SUCCESS)
		return result;
	/* A chunk that is not where it has to be would be written beside the map. */
	if (chunk->width < 0 || chunk->height < 0 || (uint32_t)chunk->width > d->map->width - x ||
		(uint32_t)chunk->height > d->map->height - y)
		result = EXR_ERR_BAD_CHUNK_LEADER;
	point_to_pixels(d, x, y);
	if (!d->begun && result == EXR_ERR_SUCCESS)
		result = exr_decoding_choose_default_routines(d->file, 0, &d->pipeline);
	d->begun = true;
	return result == EXR_ERR_SUCCESS ? exr_decoding_run(d->file, 0, &d->pipeline) : result;
}

static exr_result_t take_rows(decoding *d)
{
	exr_attr_box2i_t window;
	int32_t lines = 1;
	exr_result_t result = exr_get_data_window(d->file, 0, &window);
	if (result == EXR_ERR_SUCCESS)
		result = exr_get_scanlines_per_chunk(d->file, 0, &lines);
	for (uint32_t y = 0; y < d->map->height && result == EXR_ERR_SUCCESS; y += (uint32_t)lines) {
		exr_chunk_info_t chunk;
		result = exr_read_scanline_chunk_info(d->file, 0, window.min.y + (int)y, &chunk);
		if (result == EXR_ERR_SUCCESS)
			result = take_chunk(d, &chunk, 0, y);
	}
	return result;
}

/* The tiles of the finest level. */
static exr_result_t take_tiles(decoding *d)
{
	uint32_t w, h;
	exr_tile_level_mode_t mode;
	exr_tile_round_mode_t rounding;
	exr_result_t result = exr_get_tile_descriptor(d->file, 0, &w, &h, &mode, &rounding);
	if (result == EXR_ERR_SUCCESS && (w == 0 || h == 0))
		result = EXR_ERR_INVALID_ATTR;
	for (uint32_t y = 0; result == EXR_ERR_SUCCESS && y < d->map->height; y += h) {
		for (uint32_t x = 0; result == EXR_ERR_SUCCESS && x < d->map->width; x += w) {
			exr_chunk_info_t chunk;
			result = exr_read_tile_chunk_info(d->file, 0, (int)(x / w), (int)(y / h), 0, 0, &chunk);
			if (result == EXR_ERR_SUCCESS)
				result = take_chunk(d, &chunk, x, y);
			if (w > d->map->width)
				break;
		}
		if (h > d->map->height)
			break;
	}
	return result;
}

static exr_result_t take_pixels(exr_const_context_t file, panorama *map, bool rgb)
{
	decoding d = {
		.file = file, .map = map, .rgb = rgb, .pipeline = EXR_DECODE_PIPELINE_INITIALIZER
	};
	exr_storage_t storage;
	exr_result_t result = exr_get_storage(file, 0, &storage);
	if (result == EXR_ERR_SUCCESS)
		result = storage == EXR_STORAGE_TILED ? take_tiles(&d) : take_rows(&d);
	if (d.begun)
		exr_decoding_destroy(file, &d.pipeline);
	return result;
}

gw_status panorama_exr_read(const input_file *in, panorama *map, gw_error *error)
{
	source s = { .in = in };
	exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
	start.error_handler_fn = on_error;
	start.user_data = &s;
	start.read_fn = give_bytes;
	start.size_fn = give_size;
	start.max_image_width = 1 << 15;
	start.max_image_height = 1 << 15;
	*map = (panorama){ 0 };
	exr_context_t file = NULL;
	bool rgb = false;
	reading = &s;
	exr_result_t result = exr_start_read(&file, in->name, &start);
	gw_status status = GW_OK;
	if (result != EXR_ERR_SUCCESS)
		status = failed(&s, result, error);
	if (status == GW_OK)
		status = take_header(&s, file, map, &rgb, error);
	if (status == GW_OK && is_dwa(file)) {
		status = panorama_dwa_pixels(in, rgb, map, error);
	} else if (status == GW_OK) {
		result = take_pixels(file, map, rgb);
		if (result != EXR_ERR_SUCCESS)
			status = failed(&s, result, error);
	}
	if (file)
		exr_finish(&file);
	reading = NULL;
	for (size_t i = 0; status == GW_OK && !rgb && i < (size_t)map->width * map->height; i++)
		map->pixels[3 * i + 1] = map->pixels[3 * i + 2] = map->pixels[3 * i];
	if (status != GW_OK)
		panorama_clear(map);
	return status;
}

void panorama_openexr_version(int version[3])
{
	const char *extra;
	exr_get_library_version(&version[0], &version[1], &version[2], &extra);
}
