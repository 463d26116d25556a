/*
 * isolux.h - lines along which a picture's illuminance is the same.
 */
#ifndef ISOLUX_H
#define ISOLUX_H

#include "glowworm_picture.h"
#include "pictures/canvas.h"

#define ISOLUX_MOST 16

typedef struct isolux {
	double level[ISOLUX_MOST]; /* ascending, above 0 */
	size_t count;
} isolux;

/* Levels from text, "50,100,200". GW_ERROR_USAGE. */
gw_status isolux_read(const char *text, isolux *lines, gw_error *error);

/*
 * Draws the lines, and on each its level. They follow the mean of a few pixels around, or the noise
 * of points would tear them, and stop where one thing in the picture hides another.
 *   values   3 a pixel, of which the first counts
 */
gw_status isolux_draw(const isolux *lines, const gw_gbuffer *gbuffer, const float *values,
					  const canvas *canvas, gw_error *error);

#endif
