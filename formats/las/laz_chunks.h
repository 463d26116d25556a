/*
 * laz_chunks.h - points as compressed chunks, and what a LAZ file says of them: the LASzip VLR and
 * the table of chunks.
 *
 * Points of formats 6 to 8 are written in layers, items of version 3; those of formats 0 to 3
 * pointwise, items of version 2: byte for byte what LASzip makes of them, but that a colour which
 * never changes takes no bytes.
 */
#ifndef LAZ_CHUNKS_H
#define LAZ_CHUNKS_H

#include "las/las_records.h"
#include "las/laz_items.h"

typedef struct laz_chunk {
	size_t first, count; /* points; count > 0 */
	uint8_t *bytes;      /* owned; NULL: not compressed, or given back */
	size_t length;       /* of bytes */
} laz_chunk;

typedef struct laz_chunks {
	const las_records *records;
	laz_items items;
	uint32_t chunk_size; /* points, or LAZ_VARIABLE */
	laz_chunk *chunk;    /* owned */
	size_t count;
} laz_chunks;

/*
 * Says where chunks begin.
 *   chunks    to be given back with laz_chunks_clear, also on failure
 *   records   must live as long
 *   size      points of each chunk, the last one may have less; or LAZ_VARIABLE: then the caller
 *             says, of `count` chunks, first and count
 *   error     GW_ERROR_MEMORY
 */
gw_status laz_chunks_make(laz_chunks *chunks, const las_records *records, uint32_t size,
						  size_t count, gw_error *error);

/* Compresses chunks [first, last) on several threads. GW_ERROR_MEMORY. */
gw_status laz_chunks_pack(laz_chunks *chunks, size_t first, size_t last, gw_error *error);

/* The content of the LASzip VLR. Returns its length. */
#define LAZ_VLR_MOST (LAZ_VLR_BYTES + LAZ_ITEMS_MAX * LAZ_VLR_ITEM_BYTES)
size_t laz_chunks_vlr(const laz_chunks *chunks, uint8_t vlr[LAZ_VLR_MOST]);

/* The table of chunks, all of which were compressed. *table: for free(). GW_ERROR_MEMORY. */
gw_status laz_chunks_table(const laz_chunks *chunks, uint8_t **table, size_t *length,
						   gw_error *error);

void laz_chunks_clear(laz_chunks *chunks);

#endif
