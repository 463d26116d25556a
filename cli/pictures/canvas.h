/*
 * canvas.h - rectangles and small letters on the pixels of a picture.
 */
#ifndef CANVAS_H
#define CANVAS_H

#include <stddef.h>
#include <stdint.h>

#define CANVAS_GLYPH_WIDTH 5 /* dots */
#define CANVAS_GLYPH_HEIGHT 7
#define CANVAS_ADVANCE (CANVAS_GLYPH_WIDTH + 1) /* from letter to letter */

/* What is drawn on: `stride` bytes a pixel, 3, or 4 of which the last is opacity. */
typedef struct canvas {
	uint8_t *pixels;
	uint32_t width, height;
	size_t stride;
	uint32_t dot; /* pixels a side of a dot of the letters */
} canvas;

/* How wide dots are in a picture of that height. */
uint32_t canvas_dot(uint32_t height);

/* Fills x0 .. x1 - 1, y0 .. y1 - 1, what of it lies within the picture. */
void canvas_fill(const canvas *canvas, int64_t x0, int64_t y0, int64_t x1, int64_t y1,
				 const uint8_t rgb[3]);

/* Writes in white; capitals that there are no letters for as small ones, what else is not there as
 * blanks. */
void canvas_write(const canvas *canvas, const char *text, int64_t x, int64_t y);

#endif
