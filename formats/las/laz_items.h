/*
 * laz_items.h - of which items the points of a LAZ file are made, as the LASzip VLR lists them.
 */
#ifndef LAZ_ITEMS_H
#define LAZ_ITEMS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

#define LAZ_VLR_BYTES 34 /* of the LASzip VLR before its items */
#define LAZ_VLR_ITEM_BYTES 6
#define LAZ_VARIABLE UINT32_MAX /* chunk size: each chunk has its own count */

/* How points are put together, numbered as there. */
typedef enum laz_compressor { LAZ_POINTWISE = 1, LAZ_CHUNKED, LAZ_LAYERED } laz_compressor;

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

/* The items that points of a format have, without versions; no other order is in use.
 *   format   0 to 10
 *   record   bytes of a point, at least those of the format; what is beyond them is extra bytes */
laz_items laz_items_make(unsigned format, size_t record);

#endif
