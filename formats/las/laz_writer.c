#include "las/las_format.h"
#include "las/las_head.h"
#include "las/laz_chunks.h"
#include "files/little_endian.h"
#include "glowworm_host.h"

#include <stdlib.h>

#define CHUNK_POINTS 50000 /* as LASzip has it */

/* Chunks that are compressed before they are written, for each thread. */
#define CHUNKS_TOGETHER 4

typedef struct writer {
	output_file *out;
	las_records records;
	las_head head;
	laz_chunks chunks;
	bool patched; /* where the table is can be said before the points afterwards */
	uint64_t at;  /* bytes so far */
	gw_error *error;
} writer;

static gw_status write_bytes(writer *w, const void *bytes, size_t length)
{
	w->at += length;
	return output_file_write(w->out, bytes, length, w->error);
}

static gw_status write_chunks(writer *w, size_t first, size_t last)
{
	GW_TRY(laz_chunks_pack(&w->chunks, first, last, w->error));
	for (size_t k = first; k < last; k++) {
		laz_chunk *chunk = &w->chunks.chunk[k];
		GW_TRY(write_bytes(w, chunk->bytes, chunk->length));
		free(chunk->bytes);
		chunk->bytes = NULL;
	}
	return GW_OK;
}

static gw_status write_points(writer *w)
{
	size_t together = CHUNKS_TOGETHER * (size_t)gw_thread_count(0), count = w->chunks.count;
	for (size_t first = 0; first < count; first += together)
		GW_TRY(write_chunks(w, first, count - first < together ? count : first + together));
	return GW_OK;
}

/* The table of chunks. A pipe says at its very end where that is. */
static gw_status write_table(writer *w)
{
	uint8_t *table, place[8];
	size_t length;
	store_64(place, w->at);
	GW_TRY(laz_chunks_table(&w->chunks, &table, &length, w->error));
	gw_status status = write_bytes(w, table, length);
	free(table);
	if (status == GW_OK && w->patched)
		status =
			output_file_patch(w->out, las_head_length(&w->head), place, sizeof place, w->error);
	else if (status == GW_OK)
		status = write_bytes(w, place, sizeof place);
	return status;
}

static gw_status write_file(writer *w, const scan *cloud)
{
	uint8_t vlr[LAZ_VLR_MOST], place[8];
	GW_TRY(las_records_make(&w->records, cloud, output_file_name(w->out), false, w->error));
	GW_TRY(laz_chunks_make(&w->chunks, &w->records, CHUNK_POINTS, 0, w->error));
	GW_TRY(las_head_make(&w->head, &w->records, w->error));
	size_t length = laz_chunks_vlr(&w->chunks, vlr);
	GW_TRY(las_head_set(&w->head, LAS_HEAD_LASZIP, vlr, length, w->error));
	GW_TRY(las_head_write(&w->head, w->out, w->error));
	w->at = las_head_length(&w->head);
	store_64(place, UINT64_MAX);
	GW_TRY(write_bytes(w, place, sizeof place));
	GW_TRY(write_points(w));
	return write_table(w);
}

gw_status laz_write(output_file *out, const scan *cloud, gw_error *error)
{
	writer w = { .out = out, .patched = output_file_temporary(out), .error = error };
	gw_status status = write_file(&w, cloud);
	laz_chunks_clear(&w.chunks);
	las_head_clear(&w.head);
	las_records_clear(&w.records);
	return status;
}
