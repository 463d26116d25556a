/*
 * laz_base.h - the base of points of formats 0 to 5 in LAZ, in both versions of its coding.
 */
#ifndef LAZ_BASE_H
#define LAZ_BASE_H

#include "las/laz_values.h"

enum { LAZ_POINT10_BYTES = 20 };

/* Statistics; zeroed at the start of a chunk. */
typedef struct laz_base {
	laz_model *changed, *returns[256], *classes[256], *users[256], *angle[2];
	laz_integer dx, dy, height, intensity, source, old_angle;
	laz_model *dx_context[2], *dy_context[22], *height_context[20];
	laz_model *intensity_context[4], *source_context, *angle_context[2];
	laz_median x_median[16], y_median[16];
	uint16_t last_intensity[16];
	int32_t last_z[8];
	int32_t x_difference[3], y_difference[3]; /* of version 1: the last three, in turn */
	uint32_t turn;
} laz_base;

/* From the point before to the next one. point: LAZ_POINT10_BYTES as LAS has them
 *   next   what it is to be, when encoding; version 1 is only decoded */
void laz_base_next(laz_base *base, laz_coder *c, uint8_t *point, const uint8_t *next);
void laz_base_next_1(laz_base *base, laz_coder *c, uint8_t *point);

#endif
