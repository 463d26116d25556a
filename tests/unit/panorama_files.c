#include "panorama_files.h"
#include "exr_picture.h"

#include <OpenEXR/openexr.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Mantissas, rounded down, and their exponent. */
static void put_rgbe(const double c[3], uint8_t rgbe[4])
{
	int exponent;
	double largest = fmax(fmax(c[0], c[1]), c[2]), scale;
	frexp(largest, &exponent);
	scale = ldexp(256.0, -exponent);
	for (int k = 0; k < 3; k++)
		rgbe[k] = (uint8_t)(c[k] * scale);
	rgbe[3] = (uint8_t)(exponent + 128);
}

/* A component of a row: a run of two where two are the same, else single ones. */
static size_t put_runs(const uint8_t rgbe[][4], int component, uint8_t *out)
{
	size_t used = 0;
	for (int x = 0; x < PANORAMA_FILE_W; x++) {
		bool two = x + 1 < PANORAMA_FILE_W && rgbe[x][component] == rgbe[x + 1][component];
		out[used++] = two ? 130 : 1;
		out[used++] = rgbe[x][component];
		x += two;
	}
	return used;
}

size_t panorama_file_hdr(bool runs, uint8_t file[PANORAMA_FILE_ROOM])
{
	size_t used = (size_t)sprintf((char *)file,
								  "#?RADIANCE\n# made by hand\nFORMAT=32-bit_rle_rgbe\n"
								  "EXPOSURE= 2.0\n\n-Y %d +X %d\n",
								  PANORAMA_FILE_H, PANORAMA_FILE_W);
	for (int y = 0; y < PANORAMA_FILE_H; y++) {
		uint8_t rgbe[PANORAMA_FILE_W][4];
		for (int x = 0; x < PANORAMA_FILE_W; x++) {
			double i = y * PANORAMA_FILE_W + x;
			/* The exposure is taken out again. */
			put_rgbe((double[3]){ 2.0 * i, 4.0 * i, 0.5 }, rgbe[x]);
		}
		if (!runs) {
			memcpy(file + used, rgbe, sizeof rgbe);
			used += sizeof rgbe;
			continue;
		}
		memcpy(file + used, (uint8_t[4]){ 2, 2, 0, PANORAMA_FILE_W }, 4);
		used += 4;
		for (int c = 0; c < 4; c++)
			used += put_runs((const uint8_t(*)[4])rgbe, c, file + used);
	}
	return used;
}

static size_t take_file(const char *path, uint8_t file[PANORAMA_FILE_ROOM])
{
	FILE *in = fopen(path, "rb");
	size_t length = in ? fread(file, 1, PANORAMA_FILE_ROOM, in) : 0;
	if (in)
		fclose(in);
	unlink(path);
	return length;
}

size_t panorama_file_exr(bool grey, uint8_t file[PANORAMA_FILE_ROOM])
{
	float pixels[3 * PANORAMA_FILE_W * PANORAMA_FILE_H];
	for (int i = 0; i < PANORAMA_FILE_W * PANORAMA_FILE_H; i++) {
		pixels[3 * i] = (float)i;
		pixels[3 * i + 1] = 2.0f * (float)i;
		pixels[3 * i + 2] = 0.25f;
	}
	const exr_channel channel[] = { { grey ? "Y" : "R", false, pixels, 3 },
									{ "G", false, pixels + 1, 3 },
									{ "B", false, pixels + 2, 3 } };
	exr_picture picture = { PANORAMA_FILE_W, PANORAMA_FILE_H, channel, grey ? 1 : 3, NULL, 0 };
	char path[64];
	snprintf(path, sizeof path, "panorama_files.%d.tmp", (int)getpid());
	output_file *out;
	size_t length = 0;
	if (output_file_create(&out, path, true, NULL) != GW_OK)
		return 0;
	if (exr_picture_write(out, &picture, NULL) == GW_OK && output_file_commit(&out, NULL) == GW_OK)
		length = take_file(path, file);
	output_file_abandon(&out);
	return length;
}

enum { TILE_W = 10, TILE_H = 5 };

/* A tile of each channel: pixel i of the map is i, 2 i, 0.25. */
static exr_result_t put_tile(exr_context_t file, int x, int y, exr_encode_pipeline_t *encoder,
							 float pixels[3][TILE_W * TILE_H])
{
	exr_chunk_info_t chunk;
	exr_result_t result = exr_write_tile_chunk_info(file, 0, x, y, 0, 0, &chunk);
	if (result == EXR_ERR_SUCCESS)
		result = x + y > 0 ? exr_encoding_update(file, 0, &chunk, encoder)
						   : exr_encoding_initialize(file, 0, &chunk, encoder);
	for (int16_t c = 0; c < 3 && result == EXR_ERR_SUCCESS; c++) {
		exr_coding_channel_info_t *to = encoder->channels + c;
		int kind = *to->channel_name == 'R' ? 0 : *to->channel_name == 'G' ? 1 : 2;
		for (int row = 0; row < chunk.height; row++) {
			for (int column = 0; column < chunk.width; column++) {
				int i = (y * TILE_H + row) * PANORAMA_FILE_W + x * TILE_W + column;
				pixels[c][row * chunk.width + column] = kind == 2 ? 0.25f : (float)(i << kind);
			}
		}
		to->encode_from_ptr = (const uint8_t *)pixels[c];
		to->user_pixel_stride = 4;
		to->user_line_stride = 4 * chunk.width;
		to->user_bytes_per_element = 4;
		to->user_data_type = EXR_PIXEL_FLOAT;
	}
	if (result == EXR_ERR_SUCCESS && x + y == 0)
		result = exr_encoding_choose_default_routines(file, 0, encoder);
	return result == EXR_ERR_SUCCESS ? exr_encoding_run(file, 0, encoder) : result;
}

size_t panorama_file_tiles(uint8_t file[PANORAMA_FILE_ROOM])
{
	char path[64];
	snprintf(path, sizeof path, "panorama_tiles.%d.tmp", (int)getpid());
	exr_context_t out = NULL;
	exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
	exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
	float pixels[3][TILE_W * TILE_H];
	int part;
	if (exr_start_write(&out, path, EXR_WRITE_FILE_DIRECTLY, &start) != EXR_ERR_SUCCESS)
		return 0;
	exr_add_part(out, "tiles", EXR_STORAGE_TILED, &part);
	exr_initialize_required_attr_simple(out, 0, PANORAMA_FILE_W, PANORAMA_FILE_H,
										EXR_COMPRESSION_RLE);
	exr_set_tile_descriptor(out, 0, TILE_W, TILE_H, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
	for (int c = 0; c < 3; c++)
		exr_add_channel(out, 0, (const char *[]){ "R", "G", "B" }[c], EXR_PIXEL_FLOAT,
						EXR_PERCEPTUALLY_LINEAR, 1, 1);
	exr_result_t result = exr_write_header(out);
	for (int i = 0; i < 4 && result == EXR_ERR_SUCCESS; i++)
		result = put_tile(out, i % 2, i / 2, &encoder, pixels);
	exr_encoding_destroy(out, &encoder);
	exr_finish(&out);
	return result == EXR_ERR_SUCCESS ? take_file(path, file) : 0;
}
