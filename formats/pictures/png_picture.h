/*
 * png_picture.h - pictures for the screen: PNG, 8 bits a channel, sRGB.
 */
#ifndef PNG_PICTURE_H
#define PNG_PICTURE_H

#include "files/output_file.h"

/* A line of text in the file. */
typedef struct png_picture_text {
	const char *key; /* at most 79 characters: "Software", "Comment" */
	const char *text;
} png_picture_text;

typedef struct png_picture {
	uint32_t width, height; /* pixels */
	bool alpha;             /* four bytes a pixel instead of three */
	const uint8_t *pixels;  /* rows from the top, without gaps; sRGB-encoded, alpha not multiplied
							   in */
	const png_picture_text *text;
	size_t text_count;
} png_picture;

/* Writes a picture. GW_ERROR_MEMORY, or GW_ERROR_IO with the output's own message. */
gw_status png_picture_write(output_file *out, const png_picture *image, gw_error *error);

#endif
