/* raster_bins.c - which primitives reach into which tile; see raster_steps.h. */
#include "picture/raster_steps.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <stdlib.h>

#define CHUNKS 64u                 /* parts that are counted by themselves */
#define COUNTERS ((size_t)1 << 24) /* at most so many, of all chunks together */

/* Tiles that a primitive reaches into, both ends included; none when x0 > x1. */
typedef struct tile_range {
	uint16_t x0, x1, y0, y1;
} tile_range;

typedef struct binning {
	const gw_raster_view *view;
	size_t tiles, chunk; /* primitives a chunk */
	tile_range *range;   /* primitives */
	uint64_t *counter;   /* chunks * tiles: how many, then where the next one goes */
	uint32_t *primitive;
} binning;

static void count_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	const binning *b = user;
	const gw_raster_view *view = b->view;
	uint64_t *counter = b->counter + first / b->chunk * b->tiles;
	for (size_t i = first; i < last; i++) {
		gw_raster_shape shape;
		tile_range r = { 1, 0, 1, 0 };
		if (gw_raster_shape_make(view, i, &shape))
			r = (tile_range){ (uint16_t)((uint32_t)shape.x0 / view->tile),
							  (uint16_t)((uint32_t)shape.x1 / view->tile),
							  (uint16_t)((uint32_t)shape.y0 / view->tile),
							  (uint16_t)((uint32_t)shape.y1 / view->tile) };
		b->range[i] = r;
		for (size_t y = r.y0; y <= r.y1; y++)
			for (size_t x = r.x0; x <= r.x1; x++)
				counter[y * view->tiles_x + x]++;
	}
}

static void fill_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	const binning *b = user;
	uint64_t *next = b->counter + first / b->chunk * b->tiles;
	for (size_t i = first; i < last; i++) {
		tile_range r = b->range[i];
		for (size_t y = r.y0; y <= r.y1; y++)
			for (size_t x = r.x0; x <= r.x1; x++)
				b->primitive[next[y * b->view->tiles_x + x]++] = (uint32_t)i;
	}
}

/* From how many to where: tile by tile, and within it chunk by chunk. */
static uint64_t place_chunks(const binning *b, size_t chunks, uint64_t *first)
{
	uint64_t total = 0;
	for (size_t tile = 0; tile < b->tiles; tile++) {
		first[tile] = total;
		for (size_t c = 0; c < chunks; c++) {
			uint64_t count = b->counter[c * b->tiles + tile];
			b->counter[c * b->tiles + tile] = total;
			total += count;
		}
	}
	first[b->tiles] = total;
	return total;
}

static gw_status make(binning *b, size_t chunks, gw_raster_bins *bins, gw_error *error)
{
	const gw_raster_view *view = b->view;
	size_t n = view->primitives;
	b->range = gw_allocate_array(n, sizeof *b->range);
	b->counter = gw_allocate_zeros(chunks * b->tiles, sizeof *b->counter);
	bins->first = gw_allocate_array(b->tiles + 1, sizeof *bins->first);
	if (!b->range || !b->counter || !bins->first)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to sort %zu points into tiles", n);
	gw_parallel_for(view->options->threads, n, b->chunk, count_chunk, b);
	uint64_t total = place_chunks(b, chunks, bins->first);
	b->primitive = bins->primitive = gw_allocate_array(total, sizeof *bins->primitive);
	if (!b->primitive)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "no memory for %llu pieces of points; move the camera further away",
					   (unsigned long long)total);
	gw_parallel_for(view->options->threads, n, b->chunk, fill_chunk, b);
	for (size_t i = 0; i < n; i++)
		bins->drawn += b->range[i].x0 <= b->range[i].x1;
	for (size_t t = 0; t < b->tiles; t++) {
		size_t length = bins->first[t + 1] - bins->first[t];
		bins->longest = length > bins->longest ? length : bins->longest;
	}
	return GW_OK;
}

gw_status gw_raster_bins_make(const gw_raster_view *view, gw_raster_bins *bins, gw_error *error)
{
	binning b = { .view = view, .tiles = (size_t)view->tiles_x * view->tiles_y };
	size_t chunks = COUNTERS / b.tiles;
	chunks = chunks > CHUNKS ? CHUNKS : chunks > 0 ? chunks : 1;
	b.chunk = view->primitives / chunks + 1;
	*bins = (gw_raster_bins){ .drawn = 0 };
	gw_status status = make(&b, chunks, bins, error);
	free(b.range);
	free(b.counter);
	if (status != GW_OK)
		gw_raster_bins_clear(bins);
	return status;
}

void gw_raster_bins_clear(gw_raster_bins *bins)
{
	free(bins->first);
	free(bins->primitive);
	*bins = (gw_raster_bins){ .drawn = 0 };
}
