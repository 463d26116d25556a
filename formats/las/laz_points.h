/*
 * laz_points.h - the points of one LAZ chunk, one after the other, out of it or into it.
 *
 * A point is made of items, which are coded apart: the base of old or new point formats, time,
 * colour, waveform, extra bytes. Pointwise streams have one coder for all items of each point in
 * turn; layered ones have a coder for every kind of value, and separate statistics for each of
 * four scanner channels.
 */
#ifndef LAZ_POINTS_H
#define LAZ_POINTS_H

#include "las/laz_items.h"
#include "las/laz_values.h"

/* Memory for one chunk at a time. */
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

/* Starts on a chunk to be encoded, whose items are of version 2, or 3 and 4 in layers. */
void laz_points_begin(laz_points *points);

/* Appends a point to it, which stays as it is. */
void laz_points_add(laz_points *points, uint8_t *record);

/* Ends a chunk of at least one point. Returns how many bytes it has; 0 when memory was short. */
size_t laz_points_end(laz_points *points);

/* Writes those bytes. */
void laz_points_put(const laz_points *points, uint8_t *bytes);

/* What went wrong so far with a chunk that is decoded. */
typedef enum laz_trouble { LAZ_FINE, LAZ_DAMAGED, LAZ_TOO_SHORT, LAZ_NO_MEMORY } laz_trouble;
laz_trouble laz_points_trouble(const laz_points *points);

/* After the last point: bytes of a pointwise chunk that nothing was read from. */
size_t laz_points_left(const laz_points *points);

#endif
