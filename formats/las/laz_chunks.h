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
	uint8_t *ahead; /* records that come before the points, or NULL; not owned */
	size_t ahead_count;
	size_t first, count; /* points; ahead_count + count > 0 */
	uint8_t *bytes;      /* owned; NULL: not compressed, or given back */
	size_t length;       /* of bytes */
} laz_chunk;

typedef struct laz_chunks {
	const char *name;           /* of the file, for messages */
	const las_records *records; /* of the chunks that are to be compressed */
	laz_items items;
	uint32_t chunk_size; /* points, or LAZ_VARIABLE; the last chunk may have less */
	uint32_t threads;    /* 0: one a processor */
	laz_chunk *chunk;    /* owned */
	size_t count;
} laz_chunks;

/*
 * Begins without any chunk, of which the caller then says what is in them.
 *   chunks    to be given back with laz_chunks_clear
 *   records   by which the items are made
 */
void laz_chunks_begin(laz_chunks *chunks, const las_records *records, uint32_t size,
					  uint32_t threads);

/* Adds that many, all zeros. GW_ERROR_MEMORY. */
gw_status laz_chunks_add(laz_chunks *chunks, size_t count, gw_error *error);

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
