/*
 * read_back.c - see read_back.h. Rows come from the device in chunks of equal width and are packed
 * here.
 */
#include "light/read_back.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "light/transport_layout.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Surfels whose rows are found at a time, at most. */
#define CHUNK_MOST 32768u

/* Rows on their way from the device. */
typedef struct rows {
	gw_surfel_rows on_device;
	size_t chunk;          /* surfels whose rows are found at a time */
	uint32_t *host_record; /* GW_SURFEL_WEIGHTS * chunk */
	float *host_weight;
	size_t room; /* entries that the packed arrays hold */
} rows;

static gw_status create(gw_gpu *gpu, rows *r, gw_error *error)
{
	const uint64_t words = (uint64_t)GW_SURFEL_WEIGHTS * r->chunk;
	r->host_record = gw_allocate_array(words, sizeof *r->host_record);
	r->host_weight = gw_allocate_array(words, sizeof *r->host_weight);
	if (!r->host_record || !r->host_weight)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for weights of records");
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  4 * words, "records of surfels" },
							&r->on_device.record, error));
	return gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  4 * words, "weights of surfels" },
							&r->on_device.weight, error);
}

/* Room for the chunk from surfel `first` on, and for all others if theirs are as long as those so
 * far. */
static gw_status reserve(gw_read_back *b, rows *r, size_t first, gw_error *error)
{
	size_t used = b->first[first], needed = used + GW_SURFEL_WEIGHTS * r->chunk;
	if (needed > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY, "%zu surfels have more than 2^32 records near",
					   b->count);
	if (needed <= r->room)
		return GW_OK;
	double length = first > 0 ? (double)used / (double)first : 0.0;
	size_t room = needed + (size_t)(length * (double)(b->count - first));
	uint32_t *record = gw_resize_array(b->record, room, sizeof *record);
	if (record)
		b->record = record;
	float *weight = gw_resize_array(b->weight, room, sizeof *weight);
	if (weight)
		b->weight = weight;
	if (!record || !weight)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu weights of records", room);
	r->room = room;
	return GW_OK;
}

static void put_row(gw_read_back *b, size_t surfel, const uint32_t *record, const float *weight,
					size_t count)
{
	uint32_t used = b->first[surfel];
	assert(b->record != NULL && b->weight != NULL);
	memcpy(b->record + used, record, count * sizeof *record);
	memcpy(b->weight + used, weight, count * sizeof *weight);
	b->first[surfel + 1] = used + (uint32_t)count;
}

/* Which rows are looked for, and those that stay. */
typedef struct renewal {
	const gw_buffer *reach;     /* NULL: all are */
	const bool *closer;         /* those that are */
	const gw_read_back *before; /* has the others; NULL: theirs are empty */
} renewal;

static void pack(gw_read_back *b, const rows *r, const renewal *how, size_t first, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		size_t row = i * GW_SURFEL_WEIGHTS, n = 0;
		if (how->reach && !how->closer[first + i]) {
			const gw_read_back *old = how->before;
			if (!old) {
				put_row(b, first + i, r->host_record, r->host_weight, 0);
				continue;
			}
			uint32_t from = old->first[first + i];
			put_row(b, first + i, old->record + from, old->weight + from,
					old->first[first + i + 1] - from);
			continue;
		}
		while (n < GW_SURFEL_WEIGHTS && r->host_record[row + n] != GW_NONE)
			n++;
		put_row(b, first + i, r->host_record + row, r->host_weight + row, n);
	}
}

/* Whether rows of a chunk are looked for. */
static bool looks(const renewal *how, size_t first, size_t count)
{
	bool any = how->reach == NULL;
	for (size_t i = first; i < first + count && !any; i++)
		any = how->closer[i];
	return any;
}

/* Finds the rows of a chunk on the device. */
static gw_status find_chunk(const gw_record_context *on, const gw_buffer *reach, rows *r,
							gw_error *error)
{
	uint64_t bytes = 4 * (uint64_t)GW_SURFEL_WEIGHTS * r->on_device.count;
	GW_TRY(gw_records_weigh_surfels(on, reach, &r->on_device, error));
	GW_TRY(
		gw_buffer_download(on->passes->gpu, &r->on_device.record, 0, r->host_record, bytes, error));
	return gw_buffer_download(on->passes->gpu, &r->on_device.weight, 0, r->host_weight, bytes,
							  error);
}

static gw_status find_rows(const gw_record_context *on, const renewal *how, rows *r,
						   gw_read_back *b, gw_error *error)
{
	GW_TRY(create(on->passes->gpu, r, error));
	for (size_t first = 0; first < b->count; first += r->chunk) {
		size_t left = b->count - first, count = left < r->chunk ? left : r->chunk;
		r->on_device.first = first;
		r->on_device.count = count;
		GW_TRY(reserve(b, r, first, error));
		if (looks(how, first, count))
			GW_TRY(find_chunk(on, how->reach, r, error));
		pack(b, r, how, first, count);
	}
	return GW_OK;
}

/* Gives back what the lists did not need; when that fails they stay as they are. */
static void shrink(gw_read_back *b)
{
	uint32_t *record = gw_resize_array(b->record, b->first[b->count], sizeof *record);
	float *weight = gw_resize_array(b->weight, b->first[b->count], sizeof *weight);
	b->record = record ? record : b->record;
	b->weight = weight ? weight : b->weight;
}

static gw_status make(const gw_record_context *on, const renewal *how, size_t surfel_count,
					  gw_read_back *read_back, gw_error *error)
{
	rows r = { .chunk = surfel_count < CHUNK_MOST ? surfel_count : CHUNK_MOST };
	*read_back = (gw_read_back){ .count = surfel_count };
	read_back->first = gw_allocate_zeros(surfel_count + 1, sizeof *read_back->first);
	gw_status status = read_back->first ? find_rows(on, how, &r, read_back, error)
										: gw_fail(error, GW_ERROR_MEMORY,
												  "no memory for %zu surfels", surfel_count);
	gw_buffer_destroy(on->passes->gpu, &r.on_device.record);
	gw_buffer_destroy(on->passes->gpu, &r.on_device.weight);
	free(r.host_record);
	free(r.host_weight);
	if (status == GW_OK)
		shrink(read_back);
	else
		gw_read_back_clear(read_back);
	return status;
}

gw_status gw_read_back_make(const gw_record_context *on, size_t surfel_count,
							gw_read_back *read_back, gw_error *error)
{
	return make(on, &(renewal){ .reach = NULL }, surfel_count, read_back, error);
}

gw_status gw_read_back_make_some(const gw_record_context *on, const gw_buffer *reach,
								 const bool *asked, size_t surfel_count, gw_read_back *read_back,
								 gw_error *error)
{
	return make(on, &(renewal){ .reach = reach, .closer = asked }, surfel_count, read_back, error);
}

/* Rows of facets on the host. */
typedef struct facet_rows {
	const uint32_t *facet, *row, *record;
	const float *weight;
} facet_rows;

static size_t facet_row_length(const facet_rows *f, uint32_t facet)
{
	const uint32_t *record = f->record + GW_WEIGHTS * (size_t)f->row[facet];
	size_t n = 0;
	while (n < GW_WEIGHTS && record[n] != GW_NONE)
		n++;
	return n;
}

static size_t row_length(const gw_read_back *b, size_t surfel)
{
	return b->first[surfel + 1] - b->first[surfel];
}

/* Where each row will start, after all have taken what they take. */
static uint64_t count_entries(const gw_read_back *b, const facet_rows *f, uint32_t *first)
{
	uint64_t entries = 0;
	for (size_t i = 0; i < b->count; i++) {
		bool takes = row_length(b, i) == 0 && f->facet[i] != GW_NONE;
		first[i] = (uint32_t)entries;
		entries += takes ? facet_row_length(f, f->facet[i]) : row_length(b, i);
	}
	first[b->count] = (uint32_t)entries;
	return entries;
}

static gw_status take_rows(const facet_rows *f, gw_read_back *b, gw_error *error)
{
	gw_read_back all = { .count = b->count };
	all.first = gw_allocate_array(b->count + 1, sizeof *all.first);
	uint64_t entries = all.first ? count_entries(b, f, all.first) : 0;
	if (all.first && entries <= UINT32_MAX) {
		all.record = gw_allocate_array(entries, sizeof *all.record);
		all.weight = gw_allocate_array(entries, sizeof *all.weight);
	}
	if (!all.record || !all.weight) {
		gw_read_back_clear(&all);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the records of %zu surfels",
					   b->count);
	}
	for (size_t i = 0; i < b->count; i++) {
		size_t from = b->first[i], length = all.first[i + 1] - all.first[i];
		bool own = row_length(b, i) > 0 || length == 0;
		size_t row = own ? 0 : GW_WEIGHTS * (size_t)f->row[f->facet[i]];
		put_row(&all, i, own ? b->record + from : f->record + row,
				own ? b->weight + from : f->weight + row, length);
	}
	gw_read_back_clear(b);
	*b = all;
	return GW_OK;
}

gw_status gw_read_back_take_facets(const gw_record_context *on, const uint32_t *facet,
								   gw_read_back *read_back, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	const gw_records *r = on->records;
	uint64_t bytes = 4 * GW_WEIGHTS * (uint64_t)r->row_count;
	gw_view row = { 0 }, record = { 0 }, weight = { 0 };
	gw_status status =
		gw_view_open(gpu, &r->facet_row, 4 * (uint64_t)on->octree->facet_count, &row, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &r->facet_record, bytes, &record, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &r->facet_weight, bytes, &weight, error);
	if (status == GW_OK)
		status = take_rows(&(facet_rows){ facet, row.bytes, record.bytes, weight.bytes }, read_back,
						   error);
	gw_view_close(&weight);
	gw_view_close(&record);
	gw_view_close(&row);
	return status;
}

gw_status gw_read_back_again(const gw_record_context *on, const gw_buffer *reach,
							 const bool *closer, gw_read_back *read_back, gw_error *error)
{
	gw_read_back again;
	const renewal how = { reach, closer, read_back };
	GW_TRY(make(on, &how, read_back->count, &again, error));
	gw_read_back_clear(read_back);
	*read_back = again;
	return GW_OK;
}

void gw_read_back_clear(gw_read_back *read_back)
{
	if (!read_back->lent) {
		free(read_back->first);
		free(read_back->record);
		free(read_back->weight);
	}
	*read_back = (gw_read_back){ 0 };
}

typedef struct product {
	const gw_read_back *matrix;
	const float *records;
	float *surfels;
} product;

static void multiply(void *user, size_t first, size_t last, uint32_t worker)
{
	const product *p = user;
	const gw_read_back *b = p->matrix;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		float sum[3] = { 0 };
		for (uint32_t e = b->first[i]; e < b->first[i + 1]; e++) {
			const float *value = p->records + 4 * (size_t)b->record[e];
			for (int c = 0; c < 3; c++)
				sum[c] += b->weight[e] * value[c];
		}
		memcpy(p->surfels + 4 * i, sum, sizeof sum);
		p->surfels[4 * i + 3] = 0.0f;
	}
}

void gw_read_back_apply(const gw_read_back *read_back, const float *records, uint32_t threads,
						float *surfels)
{
	product p = { read_back, records, surfels };
	gw_parallel_for(gw_thread_count(threads), read_back->count, 16384, multiply, &p);
}

double gw_read_back_variance(const gw_read_back *read_back, const double *light, size_t surfel,
							 double lonely)
{
	double mean = 0.0, squares = 0.0, spread = 0.0;
	for (uint32_t e = read_back->first[surfel]; e < read_back->first[surfel + 1]; e++) {
		double weight = (double)read_back->weight[e];
		mean += weight * light[read_back->record[e]];
		squares += weight * weight;
	}
	for (uint32_t e = read_back->first[surfel]; e < read_back->first[surfel + 1]; e++) {
		double off = light[read_back->record[e]] - mean;
		spread += (double)read_back->weight[e] * off * off;
	}
	return squares > 0.999 ? lonely * mean * mean : spread / (1.0 - squares) * squares;
}
