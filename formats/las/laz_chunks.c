#include "las/laz_chunks.h"
#include "las/laz_points.h"
#include "files/little_endian.h"
#include "glowworm_host.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of records that are put together before they are compressed. */
#define BLOCK_BYTES ((size_t)1 << 16)

static gw_status fail_memory(const laz_chunks *c, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to compress %s", c->name);
}

void laz_chunks_begin(laz_chunks *c, const las_records *records, uint32_t size, uint32_t threads)
{
	*c = (laz_chunks){
		.name = records->name, .records = records, .chunk_size = size, .threads = threads
	};
	c->items = laz_items_make(records->format, records->layout.bytes);
	for (size_t i = 0; i < c->items.count; i++)
		c->items.item[i].version = c->items.layered ? 3 : 2;
	/* As many descriptions of extra bytes as a VLR holds are of fewer bytes. */
	assert(c->items.item[c->items.count - 1].size <= LAZ_EXTRA_MAX);
}

gw_status laz_chunks_add(laz_chunks *c, size_t count, gw_error *error)
{
	laz_chunk *grown = reallocarray(c->chunk, c->count + count + 1, sizeof *grown);
	if (!grown)
		return fail_memory(c, error);
	c->chunk = grown;
	memset(grown + c->count, 0, count * sizeof *grown);
	c->count += count;
	return GW_OK;
}

void laz_chunks_clear(laz_chunks *c)
{
	for (size_t k = 0; c->chunk && k < c->count; k++)
		free(c->chunk[k].bytes);
	free(c->chunk);
	*c = (laz_chunks){ 0 };
}

/* ------------------------------------------------------------------------------- compressing */

typedef struct packing {
	laz_chunks *chunks;
	size_t begin; /* number of the first one */
	struct worker {
		laz_points *points; /* owned, as is */
		uint8_t *block;     /* of records */
	} * worker;
	atomic_bool failed; /* memory was short */
} packing;

static bool open_worker(packing *p, struct worker *w)
{
	size_t record = p->chunks->items.record;
	if (!w->points)
		w->points = laz_points_create(&p->chunks->items);
	if (!w->block)
		w->block = malloc(record < BLOCK_BYTES ? BLOCK_BYTES : record);
	return w->points && w->block;
}

/* False when memory is short. */
static bool pack(const packing *p, struct worker *w, laz_chunk *k)
{
	size_t record = p->chunks->items.record;
	size_t most = record < BLOCK_BYTES ? BLOCK_BYTES / record : 1;
	laz_points_begin(w->points);
	for (size_t i = 0; i < k->ahead_count; i++)
		laz_points_add(w->points, k->ahead + i * record);
	for (size_t done = 0; done < k->count;) {
		size_t n = k->count - done < most ? k->count - done : most;
		las_records_put(p->chunks->records, k->first + done, n, w->block);
		for (size_t i = 0; i < n; i++)
			laz_points_add(w->points, w->block + i * record);
		done += n;
	}
	k->length = laz_points_end(w->points);
	k->bytes = k->length ? malloc(k->length) : NULL;
	if (k->bytes)
		laz_points_put(w->points, k->bytes);
	return k->bytes;
}

static void pack_chunks(void *user, size_t first, size_t last, uint32_t worker)
{
	packing *p = user;
	for (size_t k = p->begin + first; k < p->begin + last && !atomic_load(&p->failed); k++)
		if (!open_worker(p, &p->worker[worker]) ||
			!pack(p, &p->worker[worker], &p->chunks->chunk[k]))
			atomic_store(&p->failed, true);
}

gw_status laz_chunks_pack(laz_chunks *c, size_t first, size_t last, gw_error *error)
{
	uint32_t threads = gw_thread_count(c->threads);
	packing p = { .chunks = c, .begin = first, .worker = calloc(threads, sizeof *p.worker) };
	if (!p.worker)
		return fail_memory(c, error);
	gw_parallel_for(threads, last - first, 1, pack_chunks, &p);
	for (uint32_t w = 0; w < threads; w++) {
		laz_points_destroy(&p.worker[w].points);
		free(p.worker[w].block);
	}
	free(p.worker);
	return atomic_load(&p.failed) ? fail_memory(c, error) : GW_OK;
}

/* ---------------------------------------------------------------------------- what says so */

size_t laz_chunks_vlr(const laz_chunks *c, uint8_t vlr[LAZ_VLR_MOST])
{
	memset(vlr, 0, LAZ_VLR_BYTES);
	store_16(vlr, c->items.layered ? LAZ_LAYERED : LAZ_CHUNKED);
	/* The version of LASzip that knows all of this: 3.4. */
	vlr[4] = 3;
	vlr[5] = 4;
	store_32(vlr + 12, c->chunk_size);
	/* There are no special records. */
	memset(vlr + 16, 0xff, 16);
	store_16(vlr + 32, (uint16_t)c->items.count);
	for (size_t i = 0; i < c->items.count; i++) {
		uint8_t *to = vlr + LAZ_VLR_BYTES + i * LAZ_VLR_ITEM_BYTES;
		store_16(to, (uint16_t)c->items.item[i].type);
		store_16(to + 2, (uint16_t)c->items.item[i].size);
		store_16(to + 4, (uint16_t)c->items.item[i].version);
	}
	return LAZ_VLR_BYTES + c->items.count * LAZ_VLR_ITEM_BYTES;
}

/* Lengths of all chunks, and their counts when they differ, each near the one before. */
static void code_table(const laz_chunks *c, laz_coder *coder)
{
	laz_integer integer = { 0 };
	laz_model *context[2] = { 0 };
	int32_t count = 0, length = 0;
	for (size_t k = 0; k < c->count; k++) {
		const laz_chunk *chunk = &c->chunk[k];
		if (c->chunk_size == LAZ_VARIABLE)
			count =
				laz_near(coder, &integer, &context[0], 32, count, (int32_t)(uint32_t)chunk->count);
		length =
			laz_near(coder, &integer, &context[1], 32, length, (int32_t)(uint32_t)chunk->length);
	}
	laz_coder_finish(coder);
}

gw_status laz_chunks_table(const laz_chunks *c, uint8_t **table, size_t *length, gw_error *error)
{
	laz_pool pool = { 0 };
	laz_coder coder = { 0 };
	laz_coder_encode(&coder, &pool);
	if (c->count > 0)
		code_table(c, &coder);
	*length = 8 + coder.used;
	*table = pool.failed ? NULL : malloc(*length);
	if (*table) {
		store_32(*table, 0); /* version */
		store_32(*table + 4, (uint32_t)c->count);
		if (coder.used > 0)
			memcpy(*table + 8, coder.bytes, coder.used);
	}
	laz_coder_clear(&coder);
	laz_pool_clear(&pool);
	return *table ? GW_OK : fail_memory(c, error);
}
