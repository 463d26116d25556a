/*
 * exr_picture.h - pictures as numbers: OpenEXR, scene-linear, one part of scan lines with any
 * channels, by OpenEXRCore.
 */
#ifndef EXR_PICTURE_H
#define EXR_PICTURE_H

#include "files/output_file.h"

/* One channel. A layer's name and a dot stand in front of its channels' names: "direct.R". */
typedef struct exr_channel {
	const char *name;
	bool whole;         /* 32-bit unsigned integers instead of 32-bit floats */
	const void *values; /* of the first pixel; float or uint32_t */
	size_t stride;      /* values from one pixel to the next */
} exr_channel;

/* A text attribute of the file. */
typedef struct exr_text {
	const char *name;
	const char *text;
} exr_text;

typedef struct exr_picture {
	uint32_t width, height; /* pixels */
	const exr_channel *channel;
	size_t channel_count;
	const exr_text *text;
	size_t text_count;
} exr_picture;

/*
 * Writes a picture, compressed without loss (ZIP), with the chromaticities of Rec.709. It is put
 * together in memory, because parts of a file are written out of order.
 * GW_ERROR_MEMORY; GW_ERROR_INTERNAL when OpenEXRCore refuses; GW_ERROR_IO.
 */
gw_status exr_picture_write(output_file *out, const exr_picture *picture, gw_error *error);

#endif
