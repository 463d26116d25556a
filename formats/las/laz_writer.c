#include "las/las_format.h"
#include "las/las_head.h"
#include "las/laz_chunks.h"
#include "files/little_endian.h"
#include "glowworm_host.h"

#include <stdlib.h>

#define CHUNK_POINTS 50000 /* as LASzip has it */

#define PLACE_BYTES 8 /* before the first chunk: where the table of chunks is */

/* Chunks that are compressed before they are written, for each thread. */
#define CHUNKS_TOGETHER 4

typedef struct writer {
	output_file *out;
	las_records records;
	las_head head;
	laz_chunks chunks;
	uint64_t at; /* bytes so far */
	gw_error *error;
} writer;

static gw_status write_bytes(writer *w, const void *bytes, size_t length)
{
	w->at += length;
	return output_file_write(w->out, bytes, length, w->error);
}

/* Writes chunks that were compressed, and gives them back. */
static gw_status write_chunks(writer *w, size_t first, size_t last)
{
	for (size_t k = first; k < last; k++) {
		laz_chunk *chunk = &w->chunks.chunk[k];
		GW_TRY(write_bytes(w, chunk->bytes, chunk->length));
		free(chunk->bytes);
		chunk->bytes = NULL;
	}
	return GW_OK;
}

static gw_status write_table(writer *w)
{
	uint8_t *table;
	size_t length;
	GW_TRY(laz_chunks_table(&w->chunks, &table, &length, w->error));
	gw_status status = write_bytes(w, table, length);
	free(table);
	return status;
}

/* Some chunks at a time; where the table of chunks is, is said before them afterwards. */
static gw_status write_to_file(writer *w)
{
	uint8_t place[PLACE_BYTES] = { 0 };
	size_t together = CHUNKS_TOGETHER * (size_t)gw_thread_count(0), count = w->chunks.count;
	GW_TRY(write_bytes(w, place, sizeof place));
	for (size_t first = 0; first < count; first += together) {
		size_t last = count - first < together ? count : first + together;
		GW_TRY(laz_chunks_pack(&w->chunks, first, last, w->error));
		GW_TRY(write_chunks(w, first, last));
	}
	store_64(place, w->at);
	GW_TRY(write_table(w));
	return output_file_patch(w->out, las_head_length(&w->head), place, sizeof place, w->error);
}

/* All chunks before the first byte. Their place could also stand at the very end, but few programs
 * look for it there. */
static gw_status write_to_pipe(writer *w)
{
	uint8_t place[PLACE_BYTES];
	uint64_t table = w->at + sizeof place;
	GW_TRY(laz_chunks_pack(&w->chunks, 0, w->chunks.count, w->error));
	for (size_t k = 0; k < w->chunks.count; k++)
		table += w->chunks.chunk[k].length;
	store_64(place, table);
	GW_TRY(write_bytes(w, place, sizeof place));
	GW_TRY(write_chunks(w, 0, w->chunks.count));
	return write_table(w);
}

static gw_status write_all(writer *w, const scan *cloud)
{
	uint8_t vlr[LAZ_VLR_MOST];
	GW_TRY(las_records_make(&w->records, cloud, output_file_name(w->out), false, w->error));
	GW_TRY(laz_chunks_make(&w->chunks, &w->records, CHUNK_POINTS, 0, w->error));
	GW_TRY(las_head_make(&w->head, &w->records, w->error));
	size_t length = laz_chunks_vlr(&w->chunks, vlr);
	GW_TRY(las_head_set(&w->head, LAS_HEAD_LASZIP, vlr, length, w->error));
	GW_TRY(las_head_write(&w->head, w->out, w->error));
	w->at = las_head_length(&w->head);
	return output_file_temporary(w->out) ? write_to_file(w) : write_to_pipe(w);
}

gw_status laz_write(output_file *out, const scan *cloud, gw_error *error)
{
	writer w = { .out = out, .error = error };
	gw_status status = write_all(&w, cloud);
	laz_chunks_clear(&w.chunks);
	las_head_clear(&w.head);
	las_records_clear(&w.records);
	return status;
}
