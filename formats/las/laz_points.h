/*
 * laz_points.h - the points of one LAZ chunk, one after the other.
 *
 * A point is made of items, which are coded apart: the base of old or new point formats, time,
 * colour, waveform, extra bytes. Pointwise streams have one decoder for all items of each point in
 * turn; layered ones have a decoder for every kind of value, and separate statistics for each of
 * four scanner channels.
 */
#ifndef LAZ_POINTS_H
#define LAZ_POINTS_H

#include "las/laz_values.h"

/* Numbers as in the LASzip VLR. */
typedef enum laz_item_type {
	LAZ_BYTE = 0,
	LAZ_POINT10 = 6,
	LAZ_GPSTIME11,
	LAZ_RGB12,
	LAZ_WAVEPACKET13,
	LAZ_POINT14,
	LAZ_RGB14,
	LAZ_RGBNIR14,
	LAZ_WAVEPACKET14,
	LAZ_BYTE14,
} laz_item_type;

#define LAZ_ITEMS_MAX 5 /* base, time, colour, waveform, extra bytes */
#define LAZ_EXTRA_MAX 4096

typedef struct laz_item {
	laz_item_type type;
	size_t size; /* bytes */
	unsigned version;
	size_t place; /* in the record */
} laz_item;

typedef struct laz_items {
	laz_item item[LAZ_ITEMS_MAX];
	size_t count;
	size_t record; /* bytes of all together */
	bool layered;
} laz_items;

/* Memory for decoding one chunk at a time. */
typedef struct laz_points laz_points;

/* NULL when memory is short. items must live as long. */
laz_points *laz_points_create(const laz_items *items);
void laz_points_destroy(laz_points **points);

/* Bytes that a chunk of `count` points has at least. */
size_t laz_points_least(const laz_items *items, uint64_t count);

/*
 * Starts on a chunk, which holds at least laz_points_least bytes.
 * Returns false when its own sizes do not agree with that: then it is damaged.
 */
bool laz_points_start(laz_points *points, const uint8_t *data, size_t length, uint64_t count);

/* Writes the next point to `record`. */
void laz_points_next(laz_points *points, uint8_t *record);

/* What went wrong so far. */
typedef enum laz_trouble { LAZ_FINE, LAZ_DAMAGED, LAZ_TOO_SHORT, LAZ_NO_MEMORY } laz_trouble;
laz_trouble laz_points_trouble(const laz_points *points);

/* After the last point: bytes of a pointwise chunk that nothing was read from. */
size_t laz_points_left(const laz_points *points);

#endif
