/*
 * false_color.h - numbers as colours, and the scale that says which is which.
 */
#ifndef FALSE_COLOR_H
#define FALSE_COLOR_H

#include "files/number_text.h"
#include "glowworm.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Which numbers the colours stand for. */
typedef struct false_color_range {
	double low, high; /* low < high; of a logarithmic range both above 0 */
	bool logarithmic;
	const char *unit; /* above the scale; "" for none */
} false_color_range;

/*
 * A range for count values, which are changed in their order. Logarithmic: up to the largest value
 * but one in a thousand, and down to the smallest but one in a hundred, at most three powers of
 * ten. Linear: from the smallest to the largest, but one in a thousand. Values that are not above 0
 * do not count in a logarithmic one. Without values 0.1 to 1.
 */
false_color_range false_color_fit(float *values, size_t count, bool logarithmic);

/* The colour of a value, encoded for the screen: from black over violet, red and yellow to white,
 * ever lighter, so that it can also be read in grey, and in steps that look alike (CIELAB). */
void false_color_of(const false_color_range *range, double value, uint8_t rgb[3]);

/* A range from text: "0,500", or "0.1,500,log". GW_ERROR_USAGE; the unit is left empty. */
gw_status false_color_read(const char *text, false_color_range *range, gw_error *error);

/* A number for people, to three digits. */
void false_color_number(double value, char text[NUMBER_TEXT]);

/* Draws the scale onto the right side of a picture of which `stride` bytes are a pixel, the fourth
 * being opacity. A picture too small for it, less than 160 x 120, is left alone. */
void false_color_draw_scale(const false_color_range *range, uint8_t *pixels, uint32_t width,
							uint32_t height, size_t stride);

#endif
