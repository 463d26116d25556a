#include "las/laz_reader.h"
#include "las/laz_points.h"
#include "files/little_endian.h"
#include "glowworm_host.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Points that are decoded before they are handed on, and between looks for trouble. */
#define BLOCK_POINTS 256

/* Points a byte that are believed without a trial: real data has less than one. */
#define BELIEVED 16

typedef struct chunk {
	uint64_t first, count; /* points */
	size_t start, length;  /* bytes in the file */
} chunk;

struct laz_stream {
	const input_file *in;
	const las_header *header;
	laz_compressor compressor;
	laz_items items;
	uint32_t chunk_size;
	chunk *chunk; /* owned */
	size_t chunk_count;
	size_t begin;        /* number of the first one that is asked for */
	laz_points **worker; /* owned; worker_count, made when one has its first chunk */
	uint32_t worker_count;
	format_rows rows; /* that are asked for */
	laz_sink *sink;
	void *user;
	atomic_size_t failed; /* lowest number of a chunk with trouble */
};

/* ------------------------------------------------------------------------------------ items */

static const char *item_name(unsigned type)
{
	static const char *const name[] = { "BYTE",     "SHORT",        "INT",     "LONG",
										"FLOAT",    "DOUBLE",       "POINT10", "GPSTIME11",
										"RGB12",    "WAVEPACKET13", "POINT14", "RGB14",
										"RGBNIR14", "WAVEPACKET14", "BYTE14" };
	return type < sizeof name / sizeof *name ? name[type] : "unknown";
}

static bool known_version(const laz_item *item, unsigned version)
{
	if (item->type == LAZ_WAVEPACKET13)
		return version == 1;
	if (item->type >= LAZ_POINT14)
		return version >= 2 && version <= 4;
	return version == 1 || version == 2;
}

static gw_status take_items(laz_stream *s, gw_error *error)
{
	const las_vlr *vlr = &s->header->laszip;
	size_t count = load_16(vlr->data + 32);
	s->items = laz_items_make(s->header->format, s->header->record);
	if (count != s->items.count || vlr->length < LAZ_VLR_BYTES + count * LAZ_VLR_ITEM_BYTES)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: the LASzip record lists %zu items in %zu bytes; points of format %u "
					   "and %zu bytes have %zu",
					   s->in->name, count, vlr->length, s->header->format, s->header->record,
					   s->items.count);
	for (size_t i = 0; i < count; i++) {
		const uint8_t *from = vlr->data + LAZ_VLR_BYTES + i * LAZ_VLR_ITEM_BYTES;
		laz_item *item = &s->items.item[i];
		unsigned type = load_16(from), size = load_16(from + 2);
		item->version = load_16(from + 4);
		bool mixed = (item->version < 4) != (s->items.item[0].version < 4);
		if (type != item->type || size != item->size || mixed ||
			!known_version(item, item->version))
			return gw_fail(error, GW_ERROR_DATA,
						   "%s: item %zu of the LASzip record is %s (%u) of %u bytes, version %u, "
						   "which cannot be read where %s of %zu bytes is expected",
						   s->in->name, i + 1, item_name(type), type, size, item->version,
						   item_name(item->type), item->size);
	}
	if (s->items.item[count - 1].size > LAZ_EXTRA_MAX)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: points have %zu extra bytes, of which at most %d can be decompressed",
					   s->in->name, s->items.item[count - 1].size, LAZ_EXTRA_MAX);
	return GW_OK;
}

static gw_status take_vlr(laz_stream *s, gw_error *error)
{
	const las_vlr *vlr = &s->header->laszip;
	if (vlr->length < LAZ_VLR_BYTES)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: the points are compressed, but no LASzip record before them says how",
					   s->in->name);
	unsigned kind = load_16(vlr->data), coder = load_16(vlr->data + 2);
	bool layered = s->header->format >= 6;
	s->chunk_size = load_32(vlr->data + 12);
	if (kind < LAZ_POINTWISE || kind > LAZ_LAYERED || (kind == LAZ_LAYERED) != layered ||
		coder != 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: the points of format %u are compressed by compressor %u with coder %u; "
					   "with coder 0, compressors 1 and 2 (formats 0 to 5) and 3 (6 to 10) can be "
					   "read",
					   s->in->name, s->header->format, kind, coder);
	s->compressor = (laz_compressor)kind;
	return take_items(s, error);
}

/* ----------------------------------------------------------------------------------- chunks */

static gw_status fail_table(const laz_stream *s, size_t at, const char *what, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA, "%s, byte %zu: %s; the file is cut short or damaged",
				   s->in->name, at, what);
}

/* Where the table of chunks stands; what writes to a pipe can only say so at the very end. */
static gw_status find_table(const laz_stream *s, size_t *table, gw_error *error)
{
	size_t length = s->in->length, points = s->header->points;
	if (length - points < 16)
		return fail_table(s, points, "no room for compressed points", error);
	uint64_t place = load_64(s->in->data + points);
	if (place == UINT64_MAX)
		place = load_64(s->in->data + length - 8);
	if (place < points + 8 || place > length - 8)
		return fail_table(s, points, "the table of chunks shall be where the file is not", error);
	if (load_32(s->in->data + place) != 0)
		return fail_table(s, (size_t)place, "a table of chunks of an unknown version", error);
	*table = (size_t)place;
	return GW_OK;
}

/* Sizes of all chunks, and their counts when they differ, by differences. */
static gw_status decode_table(laz_stream *s, size_t table, gw_error *error)
{
	laz_pool pool = { 0 };
	laz_coder d;
	laz_integer integer = { 0 };
	laz_model *context[2] = { 0 };
	int32_t count = 0, length = 0;
	laz_coder_decode(&d, s->in->data + table + 8, s->in->length - table - 8, &pool);
	for (size_t c = 0; c < s->chunk_count && d.over == 0; c++) {
		if (s->chunk_size == LAZ_VARIABLE)
			count = laz_near(&d, &integer, &context[0], 32, count, 0);
		length = laz_near(&d, &integer, &context[1], 32, length, 0);
		s->chunk[c].count = s->chunk_size == LAZ_VARIABLE ? (uint32_t)count : s->chunk_size;
		s->chunk[c].length = (uint32_t)length;
	}
	bool short_of_memory = pool.failed;
	laz_pool_clear(&pool);
	if (short_of_memory)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to decompress %s", s->in->name);
	if (d.failed || d.over > 0)
		return fail_table(s, table + 8, "a table of chunks that makes no sense", error);
	return GW_OK;
}

/* Chunks lie one behind the other between the points' start and the table, and together have as
 * many points as the header says. */
static gw_status place_chunks(laz_stream *s, size_t table, gw_error *error)
{
	uint64_t first = 0, total = s->header->count;
	size_t at = s->header->points + 8;
	for (size_t c = 0; c < s->chunk_count; c++) {
		chunk *k = &s->chunk[c];
		k->first = first;
		k->start = at;
		if (s->chunk_size != LAZ_VARIABLE && k->count > total - first)
			k->count = total - first;
		if (k->count > total - first || k->count == 0)
			return gw_fail(error, GW_ERROR_DATA,
						   "%s: chunk %zu of %zu has %" PRIu64 " points, where %" PRIu64
						   " of the header's %" PRIu64 " are left",
						   s->in->name, c + 1, s->chunk_count, k->count, total - first, total);
		if (k->length > table - at || k->length < laz_points_least(&s->items, k->count))
			return gw_fail(error, GW_ERROR_DATA,
						   "%s, byte %zu: chunk %zu of %zu shall have %zu bytes, which is too few "
						   "or reaches beyond the table of chunks at byte %zu",
						   s->in->name, at, c + 1, s->chunk_count, k->length, table);
		first += k->count;
		at += k->length;
	}
	if (first != total)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: the header counts %" PRIu64 " points, but the %zu chunks have %" PRIu64
					   "; the file is cut short or damaged",
					   s->in->name, total, s->chunk_count, first);
	return GW_OK;
}

static gw_status allocate_chunks(laz_stream *s, size_t count, gw_error *error)
{
	s->chunk_count = count;
	s->chunk = calloc(count ? count : 1, sizeof *s->chunk);
	if (!s->chunk)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu chunks of %s", count,
					   s->in->name);
	return GW_OK;
}

static gw_status take_table(laz_stream *s, gw_error *error)
{
	size_t table = 0;
	if (s->chunk_size == 0)
		return gw_fail(error, GW_ERROR_DATA, "%s: the LASzip record says that chunks have 0 points",
					   s->in->name);
	GW_TRY(find_table(s, &table, error));
	size_t count = load_32(s->in->data + table + 4);
	size_t most = (table - s->header->points - 8) / laz_points_least(&s->items, 1);
	if (count > most)
		return gw_fail(
			error, GW_ERROR_DATA,
			"%s, byte %zu: %zu chunks, but the bytes before are enough for %zu; the file "
			"is cut short or damaged",
			s->in->name, table + 4, count, most);
	GW_TRY(allocate_chunks(s, count, error));
	if (count > 0)
		GW_TRY(decode_table(s, table, error));
	return place_chunks(s, table, error);
}

/* One stream to the end of the file, or to what follows it. */
static gw_status take_whole(laz_stream *s, gw_error *error)
{
	size_t length = s->in->length - s->header->points;
	if (length < laz_points_least(&s->items, s->header->count))
		return fail_table(s, s->header->points, "no room for compressed points", error);
	GW_TRY(allocate_chunks(s, 1, error));
	s->chunk[0] = (chunk){ 0, s->header->count, s->header->points, length };
	return GW_OK;
}

/* --------------------------------------------------------------------------------- decoding */

/* Hands on those of the points from number `first` on that were asked for. */
static void hand_on(const laz_stream *s, uint64_t first, size_t count, const uint8_t *records)
{
	uint64_t from = first > s->rows.first ? first : s->rows.first;
	uint64_t last = first + count, end = s->rows.first + s->rows.count;
	last = last < end ? last : end;
	if (s->sink && from < last)
		s->sink(s->user, (size_t)from, (size_t)(last - from),
				records + (from - first) * s->items.record);
}

/* Decodes a chunk, as far as it is asked for. Returns what is wrong with it. */
static laz_trouble decode(laz_stream *s, laz_points *points, const chunk *k)
{
	_Alignas(8) uint8_t block[BLOCK_POINTS * 68];
	size_t record = s->items.record, capacity = sizeof block / record;
	uint8_t *large = capacity ? NULL : malloc(record);
	uint8_t *records = capacity ? block : large;
	if (!records)
		return LAZ_NO_MEMORY;
	capacity = capacity ? capacity : 1;
	bool started = laz_points_start(points, s->in->data + k->start, k->length, k->count);
	laz_trouble trouble = started ? LAZ_FINE : LAZ_DAMAGED;
	uint64_t end = s->rows.first + s->rows.count - k->first;
	end = end < k->count ? end : k->count;
	for (uint64_t done = 0; done < end && trouble == LAZ_FINE;) {
		size_t n = end - done < capacity ? (size_t)(end - done) : capacity;
		for (size_t i = 0; i < n; i++)
			laz_points_next(points, records + i * record);
		trouble = laz_points_trouble(points);
		if (trouble == LAZ_FINE)
			hand_on(s, k->first + done, n, records);
		done += n;
	}
	free(large);
	/* Readers that take chunks from a stream find the next one only if this one ends with it. */
	if (trouble == LAZ_FINE && end == k->count && s->compressor == LAZ_CHUNKED && k->count > 1 &&
		laz_points_left(points))
		trouble = LAZ_DAMAGED;
	return trouble;
}

static void decode_chunks(void *user, size_t first, size_t last, uint32_t worker)
{
	laz_stream *s = user;
	for (size_t c = s->begin + first; c < s->begin + last && c < atomic_load(&s->failed); c++) {
		if (!s->worker[worker])
			s->worker[worker] = laz_points_create(&s->items);
		laz_trouble trouble =
			s->worker[worker] ? decode(s, s->worker[worker], &s->chunk[c]) : LAZ_NO_MEMORY;
		size_t lowest = atomic_load(&s->failed);
		while (trouble != LAZ_FINE && c < lowest &&
			   !atomic_compare_exchange_weak(&s->failed, &lowest, c)) {
		}
	}
}

/* Says what is wrong with a chunk, by decoding it once more. */
static gw_status explain(laz_stream *s, gw_error *error)
{
	const chunk *k = &s->chunk[atomic_load(&s->failed)];
	laz_sink *sink = s->sink;
	laz_points *points = laz_points_create(&s->items);
	s->sink = NULL;
	laz_trouble trouble = points ? decode(s, points, k) : LAZ_NO_MEMORY;
	s->sink = sink;
	laz_points_destroy(&points);
	if (trouble == LAZ_NO_MEMORY || trouble == LAZ_FINE)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to decompress %s", s->in->name);
	return gw_fail(
		error, GW_ERROR_DATA,
		"%s, byte %zu: chunk %zu of %zu, of %" PRIu64 " points in %zu bytes, %s; the file "
		"is damaged",
		s->in->name, k->start, atomic_load(&s->failed) + 1, s->chunk_count, k->count, k->length,
		trouble == LAZ_TOO_SHORT ? "ends before its last point"
								 : "holds what no compressor writes");
}

/* The number of the first chunk that ends behind a point. */
static size_t chunk_behind(const laz_stream *s, uint64_t point)
{
	size_t low = 0, high = s->chunk_count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (s->chunk[middle].first + s->chunk[middle].count <= point)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

gw_status laz_decode(laz_stream *s, const format_rows *rows, laz_sink *sink, void *user,
					 gw_error *error)
{
	if (rows->count == 0)
		return GW_OK;
	s->rows = *rows;
	s->sink = sink;
	s->user = user;
	s->begin = chunk_behind(s, rows->first);
	size_t last = chunk_behind(s, rows->first + rows->count - 1);
	last += last < s->chunk_count;
	atomic_store(&s->failed, SIZE_MAX);
	gw_parallel_for(s->worker_count, last - s->begin, 1, decode_chunks, s);
	return atomic_load(&s->failed) == SIZE_MAX ? GW_OK : explain(s, error);
}

/* -------------------------------------------------------------------------------- the stream */

/* Counts that seem too high for the bytes are tried before memory is taken for them. A coder needs
 * some hundredths of a bit for a point at least, so that a lie soon runs out of bytes. */
static gw_status try_counts(laz_stream *s, gw_error *error)
{
	for (size_t c = 0; c < s->chunk_count; c++)
		if (s->chunk[c].count / BELIEVED > s->chunk[c].length)
			return laz_decode(s, &(format_rows){ 0, s->header->count }, NULL, NULL, error);
	return GW_OK;
}

static gw_status prepare(laz_stream *s, gw_error *error)
{
	gw_status status = take_vlr(s, error);
	if (status == GW_OK && s->header->count == 0)
		status = allocate_chunks(s, 0, error);
	else if (status == GW_OK)
		status = s->compressor == LAZ_POINTWISE ? take_whole(s, error) : take_table(s, error);
	GW_TRY(status);
	uint32_t threads = gw_thread_count(s->in->threads);
	s->worker_count = s->chunk_count < threads ? (uint32_t)s->chunk_count : threads;
	s->worker_count += s->worker_count == 0;
	s->worker = calloc(s->worker_count, sizeof *s->worker);
	if (!s->worker)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to decompress %s", s->in->name);
	return try_counts(s, error);
}

gw_status laz_open(laz_stream **stream, const input_file *in, const las_header *header,
				   gw_error *error)
{
	laz_stream *s = *stream = calloc(1, sizeof *s);
	if (!s)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to decompress %s", in->name);
	s->in = in;
	s->header = header;
	gw_status status = prepare(s, error);
	if (status != GW_OK)
		laz_close(stream);
	return status;
}

uint64_t laz_chunk_points(const laz_stream *s)
{
	return s->chunk_count == 1             ? s->chunk[0].count
		   : s->chunk_size == LAZ_VARIABLE ? 1
										   : s->chunk_size;
}

void laz_close(laz_stream **stream)
{
	laz_stream *s = *stream;
	if (!s)
		return;
	for (uint32_t w = 0; s->worker && w < s->worker_count; w++)
		laz_points_destroy(&s->worker[w]);
	free(s->worker);
	free(s->chunk);
	free(s);
	*stream = NULL;
}
