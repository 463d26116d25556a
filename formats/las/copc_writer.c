#include "las/copc_tree.h"
#include "las/las_format.h"
#include "las/las_head.h"
#include "las/las_notes.h"
#include "las/laz_chunks.h"
#include "files/little_endian.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	INFO_BYTES = 160, /* of the VLR that says where the octree is */
	ENTRY_BYTES = 32, /* of a node in the table of nodes */
	EVLR_BYTES = 60,  /* of an extended VLR before its content */
	PLACE_BYTES = 8   /* before the first chunk: where the table of chunks is */
};

typedef struct writer {
	output_file *out;
	las_records records;
	copc_tree tree;
	las_head head;
	laz_chunks chunks;
	uint8_t *table, *page; /* owned: of chunks, of nodes */
	size_t table_length, page_length;
	uint64_t table_place; /* in the file */
	gw_error *error;
} writer;

static gw_status pack_nodes(writer *w)
{
	laz_chunks_begin(&w->chunks, &w->records, LAZ_VARIABLE, output_file_threads(w->out));
	GW_TRY(laz_chunks_add(&w->chunks, w->tree.node_count, w->error));
	w->records.order = w->tree.order;
	for (size_t n = 0; n < w->tree.node_count; n++) {
		w->chunks.chunk[n].first = w->tree.node[n].first;
		w->chunks.chunk[n].count = w->tree.node[n].count;
	}
	GW_TRY(laz_chunks_pack(&w->chunks, 0, w->chunks.count, w->error));
	return laz_chunks_table(&w->chunks, &w->table, &w->table_length, w->error);
}

/* The table of nodes. A cloud without points has a root without any. */
static gw_status make_page(writer *w)
{
	size_t nodes = w->tree.node_count;
	uint64_t at = las_head_length(&w->head) + PLACE_BYTES;
	w->page = calloc(nodes + 1, ENTRY_BYTES);
	if (!w->page)
		return gw_fail(w->error, GW_ERROR_MEMORY, "no memory to write %s", w->records.name);
	w->page_length = (nodes ? nodes : 1) * ENTRY_BYTES;
	for (size_t n = 0; n < nodes; n++) {
		const copc_node *node = &w->tree.node[n];
		size_t length = w->chunks.chunk[n].length;
		uint8_t *entry = w->page + n * ENTRY_BYTES;
		if (length > INT32_MAX)
			return gw_fail(w->error, GW_ERROR_DATA,
						   "%s: %zu points in one place are more than a node of COPC holds; write "
						   "LAZ",
						   w->records.name, node->count);
		store_32(entry, (uint32_t)node->level);
		for (size_t k = 0; k < 3; k++)
			store_32(entry + 4 + 4 * k, (uint32_t)node->place[k]);
		store_64(entry + 16, at);
		store_32(entry + 24, (uint32_t)length);
		store_32(entry + 28, (uint32_t)node->count);
		at += length;
	}
	w->table_place = at;
	return GW_OK;
}

/* The first and the last time of all points; 0 where there are none. */
static void find_times(const las_records *records, double times[2])
{
	const scan_column *time = NULL;
	for (size_t f = 0; f < records->own; f++)
		if (strcmp(records->layout.field[f].name, "gps_time") == 0)
			time = records->column[f];
	times[0] = time ? INFINITY : 0.0;
	times[1] = time ? -INFINITY : 0.0;
	for (size_t i = 0; time && i < records->cloud->count; i++) {
		times[0] = fmin(times[0], scan_value(time, i));
		times[1] = fmax(times[1], scan_value(time, i));
	}
	for (int k = 0; k < 2; k++)
		times[k] = isfinite(times[k]) ? times[k] : 0.0;
}

static void put_info(const writer *w, uint8_t info[INFO_BYTES])
{
	double times[2];
	find_times(&w->records, times);
	memset(info, 0, INFO_BYTES);
	for (size_t k = 0; k < 3; k++)
		store_double(info + 8 * k, w->tree.center[k]);
	store_double(info + 24, w->tree.half_size);
	store_double(info + 32, w->tree.spacing);
	store_64(info + 40, w->head.evlr + EVLR_BYTES);
	store_64(info + 48, w->page_length);
	store_double(info + 56, times[0]);
	store_double(info + 64, times[1]);
}

/* All that stands before the points, which says where all the rest is. */
static gw_status make_head(writer *w)
{
	uint8_t vlr[LAZ_VLR_MOST], info[INFO_BYTES] = { 0 };
	GW_TRY(las_head_make(&w->head, &w->records, w->error));
	size_t length = laz_chunks_vlr(&w->chunks, vlr);
	GW_TRY(las_head_set(&w->head, LAS_HEAD_LASZIP, vlr, length, w->error));
	GW_TRY(las_head_set(&w->head, LAS_HEAD_COPC, info, sizeof info, w->error));
	GW_TRY(make_page(w));
	w->head.evlr = w->table_place + w->table_length;
	w->head.evlr_count = 1;
	put_info(w, info);
	return las_head_set(&w->head, LAS_HEAD_COPC, info, sizeof info, w->error);
}

static gw_status write_parts(writer *w)
{
	uint8_t place[PLACE_BYTES], evlr[EVLR_BYTES] = { 0 };
	GW_TRY(las_head_write(&w->head, w->out, w->error));
	store_64(place, w->table_place);
	GW_TRY(output_file_write(w->out, place, sizeof place, w->error));
	for (size_t k = 0; k < w->chunks.count; k++)
		GW_TRY(output_file_write(w->out, w->chunks.chunk[k].bytes, w->chunks.chunk[k].length,
								 w->error));
	GW_TRY(output_file_write(w->out, w->table, w->table_length, w->error));
	memcpy(evlr + 2, LAS_USER_COPC, strlen(LAS_USER_COPC));
	store_16(evlr + 18, LAS_VLR_COPC_TREE);
	store_64(evlr + 20, w->page_length);
	GW_TRY(output_file_write(w->out, evlr, sizeof evlr, w->error));
	return output_file_write(w->out, w->page, w->page_length, w->error);
}

static gw_status write_file(writer *w, const scan *cloud)
{
	GW_TRY(las_records_make(&w->records, cloud, output_file_name(w->out), true, w->error));
	GW_TRY(copc_tree_make(&w->tree, &w->records, w->error));
	GW_TRY(pack_nodes(w));
	GW_TRY(make_head(w));
	return write_parts(w);
}

gw_status copc_write(output_file *out, const scan *cloud, gw_error *error)
{
	writer w = { .out = out, .error = error };
	gw_status status = write_file(&w, cloud);
	laz_chunks_clear(&w.chunks);
	las_head_clear(&w.head);
	copc_tree_clear(&w.tree);
	las_records_clear(&w.records);
	free(w.table);
	free(w.page);
	return status;
}
