#include "las/las_head.h"
#include "las/las_notes.h"
#include "files/little_endian.h"
#include "files/number_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Global encoding: what the input's stays true of, and that the coordinate system is WKT. */
enum { ENCODING_KEPT = 1 | 8, ENCODING_WKT = 16 };

/* In the point format: points are compressed. */
enum { LAS_COMPRESSED = 0x80 };

/* Whose VLRs they are, and their numbers. */
static const struct {
	const char *user;
	uint16_t id;
} names[LAS_HEAD_VLRS] = {
	[LAS_HEAD_COPC] = { LAS_USER_COPC, LAS_VLR_COPC_INFO },
	[LAS_HEAD_WKT] = { LAS_USER_CRS, LAS_VLR_WKT },
	[LAS_HEAD_KEYS] = { LAS_USER_CRS, LAS_VLR_GEO_KEYS },
	[LAS_HEAD_DOUBLES] = { LAS_USER_CRS, LAS_VLR_GEO_DOUBLES },
	[LAS_HEAD_GEO_TEXT] = { LAS_USER_CRS, LAS_VLR_GEO_TEXT },
	[LAS_HEAD_TEXT] = { LAS_USER_SPEC, LAS_VLR_TEXT },
	[LAS_HEAD_EXTRA] = { LAS_USER_SPEC, LAS_VLR_EXTRA },
	[LAS_HEAD_LASZIP] = { LAS_USER_LASZIP, LAS_VLR_LASZIP },
};

static gw_status fail_memory(const las_records *w, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", w->name);
}

/* Texts end in a zero; what is longer than a VLR is left out, which only a coordinate system of
 * 64 KB would be. */
static gw_status make_text(las_head *head, las_head_vlr which, const char *key, gw_error *error)
{
	char *text;
	gw_status status = las_note_join(head->records->cloud, key, &text, error);
	if (status != GW_OK || !text)
		return status;
	head->vlr[which].data = (uint8_t *)text;
	head->vlr[which].length = strlen(text) + 1;
	if (head->vlr[which].length > LAS_LENGTH_MAX)
		head->vlr[which].length = 0;
	return GW_OK;
}

/* Numbers of 2 or 8 bytes from text. */
static gw_status make_numbers(las_head *head, las_head_vlr which, const char *key, size_t size,
							  gw_error *error)
{
	char *text;
	gw_status status = las_note_join(head->records->cloud, key, &text, error);
	if (status != GW_OK || !text)
		return status;
	size_t length = strlen(text);
	head->vlr[which].data = reallocarray(NULL, length + 1, size);
	if (!head->vlr[which].data) {
		free(text);
		return fail_memory(head->records, error);
	}
	for (size_t at = 0, used; at < length && head->vlr[which].length + size <= LAS_LENGTH_MAX;
		 at += used + 1) {
		double value;
		used = number_read(text + at, length - at, &value);
		if (used == 0)
			break;
		if (size == 2)
			store_16(head->vlr[which].data + head->vlr[which].length,
					 value >= 0.0 && value <= 65535.0 ? (uint16_t)value : 0);
		else
			store_double(head->vlr[which].data + head->vlr[which].length, value);
		head->vlr[which].length += size;
	}
	free(text);
	return GW_OK;
}

static void add_line(las_head *head, const char *line)
{
	size_t length = strlen(line);
	if (head->vlr[LAS_HEAD_TEXT].length + length + 2 > LAS_LENGTH_MAX)
		return;
	memcpy(head->vlr[LAS_HEAD_TEXT].data + head->vlr[LAS_HEAD_TEXT].length, line, length);
	head->vlr[LAS_HEAD_TEXT].length += length;
	head->vlr[LAS_HEAD_TEXT].data[head->vlr[LAS_HEAD_TEXT].length++] = '\n';
}

static bool begins(const char *text, const char *with)
{
	return strncmp(text, with, strlen(with)) == 0;
}

/* The whole names of columns that extra values have no room for. */
static void add_names(las_head *head)
{
	const las_records *w = head->records;
	for (size_t f = w->own; f < w->layout.count; f++) {
		char line[sizeof LAS_COLUMN_LINE LAS_COLUMN_IS + LAS_EXTRA_NAME + LAS_COLUMN_NAME];
		const char *cut = w->layout.field[f].name, *whole = w->column[f]->name;
		if (strcmp(cut, whole) == 0 || strlen(whole) >= LAS_COLUMN_NAME)
			continue;
		snprintf(line, sizeof line, LAS_COLUMN_LINE "%.*s" LAS_COLUMN_IS "%s", LAS_EXTRA_NAME, cut,
				 whole);
		add_line(head, line);
	}
}

/* Names of columns, and the scan's comments, as lines, but for those that the reader makes. */
static gw_status make_comments(las_head *head, gw_error *error)
{
	const las_records *w = head->records;
	head->vlr[LAS_HEAD_TEXT].data = malloc(LAS_LENGTH_MAX);
	if (!head->vlr[LAS_HEAD_TEXT].data)
		return fail_memory(head->records, error);
	add_names(head);
	for (size_t c = 0; c < w->cloud->comment_count; c++) {
		const char *text = w->cloud->comment[c];
		if (!begins(text, LAS_NOTE) && !begins(text, SCAN_NOTE) && !begins(text, LAS_COLUMN_LINE))
			add_line(head, text);
	}
	static const char axes[3] = "xyz";
	for (int k = 0; k < 3; k++) {
		char line[80], step[NUMBER_TEXT];
		number_print(step, w->grid[k].scale);
		snprintf(line, sizeof line, "glowworm rounded %c to steps of %s", axes[k], step);
		if (!w->grid[k].exact)
			add_line(head, line);
	}
	if (head->vlr[LAS_HEAD_TEXT].length > 0)
		head->vlr[LAS_HEAD_TEXT].data[head->vlr[LAS_HEAD_TEXT].length++] = '\0';
	return GW_OK;
}

static gw_status make_extra(las_head *head, gw_error *error)
{
	const las_records *w = head->records;
	size_t count = w->layout.count - w->own;
	head->vlr[LAS_HEAD_EXTRA].data = calloc(count + 1, LAS_EXTRA_BYTES);
	if (!head->vlr[LAS_HEAD_EXTRA].data)
		return fail_memory(head->records, error);
	head->vlr[LAS_HEAD_EXTRA].length = count * LAS_EXTRA_BYTES;
	for (size_t e = 0; e < count; e++) {
		const las_field *field = &w->layout.field[w->own + e];
		uint8_t *to = head->vlr[LAS_HEAD_EXTRA].data + e * LAS_EXTRA_BYTES;
		to[2] = (uint8_t)field->kind;
		memcpy(to + 4, field->name, strnlen(field->name, LAS_EXTRA_NAME));
	}
	return GW_OK;
}

gw_status las_head_make(las_head *head, const las_records *w, gw_error *error)
{
	*head = (las_head){ .records = w };
	GW_TRY(make_text(head, LAS_HEAD_WKT, "wkt", error));
	GW_TRY(make_numbers(head, LAS_HEAD_KEYS, "geokeys", 2, error));
	GW_TRY(make_numbers(head, LAS_HEAD_DOUBLES, "geodoubles", 8, error));
	GW_TRY(make_text(head, LAS_HEAD_GEO_TEXT, "geotext", error));
	GW_TRY(make_comments(head, error));
	return make_extra(head, error);
}

gw_status las_head_set(las_head *head, las_head_vlr which, const uint8_t *data, size_t length,
					   gw_error *error)
{
	uint8_t *copy = malloc(length);
	if (!copy)
		return fail_memory(head->records, error);
	memcpy(copy, data, length);
	free(head->vlr[which].data);
	head->vlr[which].data = copy;
	head->vlr[which].length = length;
	return GW_OK;
}

void las_head_clear(las_head *head)
{
	for (int k = 0; k < LAS_HEAD_VLRS; k++)
		free(head->vlr[k].data);
	*head = (las_head){ 0 };
}

static gw_status write_vlrs(const las_head *head, output_file *out, gw_error *error)
{
	for (int k = 0; k < LAS_HEAD_VLRS; k++) {
		uint8_t start[LAS_VLR_BYTES] = { 0 };
		if (head->vlr[k].length == 0)
			continue;
		memcpy(start + 2, names[k].user, strlen(names[k].user));
		store_16(start + 18, names[k].id);
		store_16(start + 20, (uint16_t)head->vlr[k].length);
		output_file_write(out, start, sizeof start, error);
		GW_TRY(output_file_write(out, head->vlr[k].data, head->vlr[k].length, error));
	}
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- header */

/* Counts, in 64 bits; the old formats have them in 32 too, when they fit. */
static void put_counts(const las_records *w, uint8_t *h)
{
	bool old = w->format < 6 && w->total <= UINT32_MAX;
	store_64(h + 247, w->total);
	if (old)
		store_32(h + 107, (uint32_t)w->total);
	for (size_t r = 0; r < 15; r++) {
		store_64(h + 255 + 8 * r, w->returned[r]);
		if (old && r < 5)
			store_32(h + 111 + 4 * r, (uint32_t)w->returned[r]);
	}
}

/* What the input's header said of the file: encoding, source, day, year, system. */
static void put_origin(const las_records *w, bool wkt, uint8_t *h)
{
	double file[4] = { 0 };
	const char *system = NULL;
	for (size_t c = 0; c < w->cloud->comment_count; c++) {
		double read[4];
		if (las_note_read(w->cloud->comment[c], "file", read, 4) == 4)
			for (int k = 0; k < 4; k++)
				file[k] = read[k] >= 0.0 && read[k] <= 65535.0 ? floor(read[k]) : 0.0;
		if (!system)
			system = las_note_find(w->cloud->comment[c], "system");
	}
	system = system ? system : "OTHER";
	store_16(h + 4, (uint16_t)file[1]);
	store_16(h + 6, (uint16_t)(((uint16_t)file[0] & ENCODING_KEPT) | (wkt ? ENCODING_WKT : 0)));
	memcpy(h + 26, system, strnlen(system, 32));
	memcpy(h + 58, "glowworm " GW_VERSION, strlen("glowworm " GW_VERSION));
	store_16(h + 90, (uint16_t)file[2]);
	store_16(h + 92, (uint16_t)file[3]);
}

size_t las_head_length(const las_head *head)
{
	size_t length = LAS_HEADER_BYTES_1_4;
	for (int k = 0; k < LAS_HEAD_VLRS; k++)
		length += head->vlr[k].length ? LAS_VLR_BYTES + head->vlr[k].length : 0;
	return length;
}

/* New formats name their system by WKT, if any; COPC has it say so in any case. */
static bool says_wkt(const las_head *head)
{
	return head->vlr[LAS_HEAD_WKT].length > 0 || head->vlr[LAS_HEAD_COPC].length > 0 ||
		   (head->records->format >= 6 && head->vlr[LAS_HEAD_KEYS].length == 0);
}

gw_status las_head_write(const las_head *head, output_file *out, gw_error *error)
{
	const las_records *w = head->records;
	uint8_t h[LAS_HEADER_BYTES_1_4] = { 'L', 'A', 'S', 'F' };
	uint32_t vlrs = 0;
	for (int k = 0; k < LAS_HEAD_VLRS; k++)
		vlrs += head->vlr[k].length > 0;
	put_origin(w, says_wkt(head), h);
	h[24] = 1;
	h[25] = 4;
	store_16(h + 94, sizeof h);
	store_32(h + 96, (uint32_t)las_head_length(head));
	store_32(h + 100, vlrs);
	h[104] = (uint8_t)(w->format | (head->vlr[LAS_HEAD_LASZIP].length ? LAS_COMPRESSED : 0));
	store_16(h + 105, (uint16_t)w->layout.bytes);
	for (size_t k = 0; k < 3; k++) {
		store_double(h + 131 + 8 * k, w->grid[k].scale);
		store_double(h + 155 + 8 * k, w->grid[k].offset);
		store_double(h + 179 + 16 * k, w->grid[k].maximum);
		store_double(h + 187 + 16 * k, w->grid[k].minimum);
	}
	store_64(h + 235, head->evlr);
	store_32(h + 243, head->evlr_count);
	put_counts(w, h);
	GW_TRY(output_file_write(out, h, sizeof h, error));
	return write_vlrs(head, out, error);
}
