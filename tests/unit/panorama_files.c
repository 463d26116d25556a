#include "panorama_files.h"
#include "exr_picture.h"

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
	if (exr_picture_write(out, &picture, NULL) == GW_OK &&
		output_file_commit(&out, NULL) == GW_OK) {
		FILE *in = fopen(path, "rb");
		length = in ? fread(file, 1, PANORAMA_FILE_ROOM, in) : 0;
		if (in)
			fclose(in);
	}
	output_file_abandon(&out);
	unlink(path);
	return length;
}
