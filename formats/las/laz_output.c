#include "las/laz_output.h"

#include "files/little_endian.h"
#include "glowworm_host.h"
#include "las/las_head.h"

#include <stdlib.h>

#define CHUNK_POINTS 50000 /* as LASzip has it */

#define PLACE_BYTES 8 /* before the first chunk: where the table of chunks is */

/* Chunks that are compressed before they are written, for each thread. */
#define CHUNKS_TOGETHER 4

static gw_status write_bytes(laz_output *o, const void *bytes, size_t length, gw_error *error)
{
	o->at += length;
	return output_file_write(o->out, bytes, length, error);
}

static gw_status make_head(las_head *head, const laz_output *o, const las_records *records,
						   gw_error *error)
{
	uint8_t vlr[LAZ_VLR_MOST];
	GW_TRY(las_head_make(head, records, error));
	size_t length = laz_chunks_vlr(&o->chunks, vlr);
	return las_head_set(head, LAS_HEAD_LASZIP, vlr, length, error);
}

static gw_status write_head(laz_output *o, const las_records *records, output_file *out,
							gw_error *error)
{
	las_head head = { 0 };
	*o = (laz_output){ .out = out };
	laz_chunks_begin(&o->chunks, records, CHUNK_POINTS, output_file_threads(out));
	gw_status status = make_head(&head, o, records, error);
	if (status == GW_OK)
		status = las_head_write(&head, out, error);
	o->place = o->at = las_head_length(&head);
	las_head_clear(&head);
	return status;
}

gw_status laz_output_begin(laz_output *o, const las_records *records, output_file *out,
						   gw_error *error)
{
	const uint8_t place[PLACE_BYTES] = { 0 };
	GW_TRY(write_head(o, records, out, error));
	return write_bytes(o, place, sizeof place, error);
}

/* Writes chunks that were compressed, and gives them back. */
static gw_status write_chunks(laz_output *o, size_t first, size_t last, gw_error *error)
{
	for (size_t k = first; k < last; k++) {
		laz_chunk *chunk = &o->chunks.chunk[k];
		GW_TRY(write_bytes(o, chunk->bytes, chunk->length, error));
		free(chunk->bytes);
		chunk->bytes = NULL;
	}
	return GW_OK;
}

static gw_status write_table(laz_output *o, gw_error *error)
{
	uint8_t *table;
	size_t length;
	GW_TRY(laz_chunks_table(&o->chunks, &table, &length, error));
	gw_status status = write_bytes(o, table, length, error);
	free(table);
	return status;
}

/* Some chunks at a time, from one on. */
static gw_status pack_and_write(laz_output *o, size_t first, gw_error *error)
{
	size_t together = CHUNKS_TOGETHER * (size_t)gw_thread_count(o->chunks.threads);
	for (size_t count = o->chunks.count; first < count; first += together) {
		size_t last = count - first < together ? count : first + together;
		GW_TRY(laz_chunks_pack(&o->chunks, first, last, error));
		GW_TRY(write_chunks(o, first, last, error));
	}
	return GW_OK;
}

/* Adds the chunks that points fill, the first of them with those that are pending. Returns of how
 * many of the points they are.
 *   last   a chunk that is not full is one */
static gw_status place_chunks(laz_output *o, size_t points, bool last, size_t *taken,
							  gw_error *error)
{
	size_t size = o->chunks.chunk_size, all = o->pending_count + points;
	size_t count = all / size + (last && all % size > 0), before = o->chunks.count;
	*taken = 0;
	GW_TRY(laz_chunks_add(&o->chunks, count, error));
	for (size_t k = before; k < o->chunks.count; k++) {
		laz_chunk *chunk = &o->chunks.chunk[k];
		if (k == before) {
			chunk->ahead = o->pending;
			chunk->ahead_count = o->pending_count;
		}
		size_t room = size - chunk->ahead_count, rest = points - *taken;
		chunk->first = *taken;
		chunk->count = rest < room ? rest : room;
		*taken += chunk->count;
	}
	return GW_OK;
}

/* Points of a chunk that is not full wait for others. */
static gw_status keep_rest(laz_output *o, const las_records *records, size_t first, gw_error *error)
{
	size_t record = records->layout.bytes;
	if (first < records->count && !o->pending)
		o->pending = reallocarray(NULL, o->chunks.chunk_size, record);
	if (first < records->count && !o->pending)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to compress %s", records->name);
	if (first < records->count)
		las_records_put(records, first, records->count - first,
						o->pending + o->pending_count * record);
	o->pending_count += records->count - first;
	return GW_OK;
}

gw_status laz_output_add(laz_output *o, const las_records *records, gw_error *error)
{
	size_t taken, first = o->chunks.count;
	o->chunks.records = records;
	GW_TRY(place_chunks(o, records->count, false, &taken, error));
	GW_TRY(pack_and_write(o, first, error));
	if (o->chunks.count > first)
		o->pending_count = 0;
	return keep_rest(o, records, taken, error);
}

gw_status laz_output_end(laz_output *o, gw_error *error)
{
	uint8_t place[PLACE_BYTES];
	size_t taken, first = o->chunks.count;
	GW_TRY(place_chunks(o, 0, true, &taken, error));
	GW_TRY(pack_and_write(o, first, error));
	store_64(place, o->at);
	GW_TRY(write_table(o, error));
	return output_file_patch(o->out, o->place, place, sizeof place, error);
}

/* The place of the table could also stand at the very end, but few programs look for it there. */
gw_status laz_output_append(laz_output *o, const las_records *records, output_file *out,
							gw_error *error)
{
	size_t taken;
	uint8_t place[PLACE_BYTES];
	GW_TRY(write_head(o, records, out, error));
	GW_TRY(place_chunks(o, records->count, true, &taken, error));
	GW_TRY(laz_chunks_pack(&o->chunks, 0, o->chunks.count, error));
	uint64_t table = o->at + sizeof place;
	for (size_t k = 0; k < o->chunks.count; k++)
		table += o->chunks.chunk[k].length;
	store_64(place, table);
	GW_TRY(write_bytes(o, place, sizeof place, error));
	GW_TRY(write_chunks(o, 0, o->chunks.count, error));
	return write_table(o, error);
}

void laz_output_clear(laz_output *o)
{
	laz_chunks_clear(&o->chunks);
	free(o->pending);
	*o = (laz_output){ .out = NULL };
}
