/*
 * laz_values.h - kinds of values that LAZ predicts from those before them: differences of
 * coordinates, times, colours, places in waveforms.
 *
 * All structs are zeroed at the start of a chunk. Each function takes the value before and leaves
 * the next one in its place, in bytes as LAS has them; next: what that is to be, which only counts
 * when encoding. Version 1 can only be decoded.
 */
#ifndef LAZ_VALUES_H
#define LAZ_VALUES_H

#include "las/laz_coder.h"

/* A running median: five values, sorted. A new one drives out the largest or the smallest, in turn
 * as the new ones come to lie below and above the median. */
typedef struct laz_median {
	int32_t sorted[5];
	bool drop_smallest;
} laz_median;

static inline int32_t laz_median_value(const laz_median *median)
{
	return median->sorted[2];
}

void laz_median_add(laz_median *median, int32_t value);

/* Times as the bits of doubles: up to four sequences that take turns. */
typedef struct laz_time {
	uint64_t time[4];
	int32_t difference[4]; /* that the next one is likely to have, too */
	uint32_t extreme[4];   /* how often in a row it was far from it */
	uint32_t current, newest;
	laz_model *start, *multiple;
	laz_integer integer;
	laz_model *context[9];
} laz_time;

/* item: 8 bytes. The first point's time goes into sequence 0 before. In layered streams the time is
 * another one than that before. */
void laz_time_next(laz_time *time, laz_coder *c, bool layered, uint8_t *item, const uint8_t *next);
void laz_time_next_1(laz_time *time, laz_coder *c, uint8_t *item); /* of version 1 */

typedef struct laz_color {
	laz_model *used;
	laz_model *byte[6];
	laz_integer integer;
} laz_color;

/* item: 6 bytes */
void laz_color_next(laz_color *color, laz_coder *c, uint8_t *item, const uint8_t *next);
void laz_color_next_1(laz_color *color, laz_coder *c, uint8_t *item); /* of version 1 */

typedef struct laz_infrared {
	laz_model *used;
	laz_model *byte[2];
} laz_infrared;

/* item: 2 bytes */
void laz_infrared_next(laz_infrared *infrared, laz_coder *c, uint8_t *item, const uint8_t *next);

typedef struct laz_wave {
	int32_t difference; /* of offsets */
	uint32_t kind;      /* of the last offset: same, behind the last packet, near, anywhere */
	laz_model *index;
	laz_model *next_kind[4];
	laz_integer offset, size, point, direction;
	laz_model *offset_context, *size_context, *point_context, *direction_context[3];
} laz_wave;

/* item: 29 bytes */
void laz_wave_next(laz_wave *wave, laz_coder *c, uint8_t *item, const uint8_t *next);

#endif
