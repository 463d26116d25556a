#include "las/las_format.h"
#include "las/las_fields.h"
#include "las/las_grid.h"
#include "las/las_notes.h"
#include "files/little_endian.h"
#include "files/number_text.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of records that are put together before they are handed on. */
#define BLOCK_BYTES ((size_t)1 << 18)

/* What a record or the content of a VLR has at most. */
#define LENGTH_MAX ((size_t)UINT16_MAX)

/* Global encoding: what the input's stays true of, and that the coordinate system is WKT. */
enum { ENCODING_KEPT = 1 | 8, ENCODING_WKT = 16 };

typedef struct writer {
	output_file *out;
	const scan *cloud;
	unsigned format;
	las_grid grid[3];
	las_layout layout;
	size_t own;                 /* fields of the format; behind them extra ones */
	const scan_column **column; /* owned; of each field, NULL: zeros */
	scan_color color;
	bool colored, returns; /* the scan has colours, return numbers */
	gw_error *error;
} writer;

static gw_status fail_memory(const writer *w)
{
	return gw_fail(w->error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(w->out));
}

/* ------------------------------------------------------------------- which column goes where */

/* True when a field holds every value of a column exactly. */
static bool fits(const las_field *field, const scan_column *column, size_t count)
{
	if (field->kind == LAS_FLOAT64)
		return column->type == SCAN_FLOAT64;
	bool whole = field->bits == 0 && las_field_type(field) == column->type;
	size_t bits = field->bits ? field->bits : 8 * las_kind_size(field->kind);
	bool negative = field->kind == LAS_INT8 || field->kind == LAS_INT16;
	double high = ldexp(1.0, (int)bits - negative) - 1.0, low = negative ? -high - 1.0 : 0.0;
	for (size_t i = 0; i < count && !whole; i++) {
		double value = scan_value(column, i);
		if (!(value >= low && value <= high) || value != floor(value))
			return false;
	}
	return true;
}

static bool is_color(const char *name)
{
	return strcmp(name, "red") == 0 || strcmp(name, "green") == 0 || strcmp(name, "blue") == 0;
}

/* True when all columns that are called like fields of the old formats go there, and none needs a
 * field that only new ones have. */
static bool fits_old(const writer *w, const las_layout *old)
{
	static const char *const only_new[] = { "scan_angle", "overlap", "scanner_channel", "nir" };
	if (!scan_find(w->cloud, "scan_angle_rank"))
		return false;
	for (size_t i = 0; i < sizeof only_new / sizeof *only_new; i++)
		if (scan_find(w->cloud, only_new[i]))
			return false;
	for (size_t f = 3; f < old->count; f++) {
		const las_field *field = &old->field[f];
		const scan_column *column = scan_find(w->cloud, field->name);
		if (column && !is_color(field->name) && !fits(field, column, w->cloud->count))
			return false;
	}
	return true;
}

/* Formats 6 to 8 are what LAS 1.4 is for; points that come from an old format keep it, because a
 * scan angle in degrees and one in steps of 0.006 degrees are different numbers. */
static gw_status choose_format(writer *w)
{
	const double zero[3] = { 0 };
	las_layout old;
	bool time = scan_find(w->cloud, "gps_time") != NULL;
	w->returns = scan_find(w->cloud, "return_number") || scan_find(w->cloud, "number_of_returns");
	w->colored = scan_find(w->cloud, "red") && scan_find(w->cloud, "green") &&
				 scan_find(w->cloud, "blue") &&
				 scan_color_find(w->cloud, scan_color_names, &w->color);
	unsigned number = (time ? 1u : 0u) + (w->colored ? 2u : 0u);
	GW_TRY(las_layout_make(&old, number, zero, zero, w->error));
	if (!fits_old(w, &old))
		number = scan_find(w->cloud, "nir") ? 8 : w->colored ? 7 : 6;
	las_layout_clear(&old);
	w->format = number;
	return GW_OK;
}

static bool is_written(const writer *w, const char *name)
{
	for (size_t f = 0; f < w->own; f++)
		if (w->column[f] && strcmp(w->layout.field[f].name, name) == 0)
			return true;
	return false;
}

/* An extra value's name has 32 bytes: longer ones are cut, and numbered when that makes two
 * alike. */
static void name_extra(const writer *w, las_field *field, const char *name)
{
	snprintf(field->name, sizeof field->name, "%.32s", name);
	for (unsigned n = 2, again = 1; again; n++) {
		again = 0;
		for (size_t f = w->own; f < w->layout.count && !again; f++)
			again = strcmp(w->layout.field[f].name, field->name) == 0;
		if (again)
			snprintf(field->name, sizeof field->name, "%.26s_%u", name, n);
	}
}

static gw_status add_extra(writer *w, const scan_column *column)
{
	static const las_kind kind[SCAN_TYPE_COUNT] = {
		[SCAN_INT8] = LAS_INT8,       [SCAN_UINT8] = LAS_UINT8,     [SCAN_INT16] = LAS_INT16,
		[SCAN_UINT16] = LAS_UINT16,   [SCAN_INT32] = LAS_INT32,     [SCAN_UINT32] = LAS_UINT32,
		[SCAN_FLOAT32] = LAS_FLOAT32, [SCAN_FLOAT64] = LAS_FLOAT64,
	};
	las_field field = { .kind = kind[column->type], .place = w->layout.bytes };
	name_extra(w, &field, column->name);
	size_t extras = w->layout.count - w->own + 1;
	if (extras * LAS_EXTRA_BYTES > LENGTH_MAX ||
		w->layout.bytes + las_kind_size(field.kind) > LENGTH_MAX)
		return gw_fail(
			w->error, GW_ERROR_DATA,
			"%s: the points have more columns than LAS holds, of which %zu are no fields "
			"of its points; write PLY",
			output_file_name(w->out), extras);
	w->column[w->layout.count] = column;
	return las_layout_add(&w->layout, &field, w->error);
}

/* An angle of the old formats, in degrees, for the new ones; it also stays as it is. */
static const scan_column *find_rank(const scan *cloud)
{
	const scan_column *rank = scan_find(cloud, "scan_angle_rank");
	return rank && rank->type == SCAN_INT8 ? rank : NULL;
}

static gw_status assign_columns(writer *w)
{
	const double scale[3] = { w->grid[0].scale, w->grid[1].scale, w->grid[2].scale };
	const double offset[3] = { w->grid[0].offset, w->grid[1].offset, w->grid[2].offset };
	GW_TRY(las_layout_make(&w->layout, w->format, scale, offset, w->error));
	w->own = w->layout.count;
	w->column = calloc(w->own + w->cloud->column_count, sizeof *w->column);
	if (!w->column)
		return fail_memory(w);
	for (size_t f = 0; f < w->own; f++) {
		const las_field *field = &w->layout.field[f];
		const scan_column *column = scan_find(w->cloud, field->name);
		bool taken = is_color(field->name)
						 ? w->colored
						 : field->scaled || !column || fits(field, column, w->cloud->count);
		w->column[f] = taken ? column : NULL;
		if (strcmp(field->name, "scan_angle") == 0 && !column)
			w->column[f] = find_rank(w->cloud);
	}
	for (size_t c = 0; c < w->cloud->column_count; c++)
		if (!is_written(w, w->cloud->column[c].name))
			GW_TRY(add_extra(w, &w->cloud->column[c]));
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- records */

static uint16_t color_value(const writer *w, const scan_column *column, size_t i)
{
	int channel = 0;
	while (w->color.column[channel] != column && channel < 2)
		channel++;
	double value = scan_color_value(&w->color, channel, i);
	return value > 0.0 ? (uint16_t)(fmin(value, 1.0) * 65535.0 + 0.5) : 0;
}

static void put_bytes(uint8_t *to, uint64_t bits, size_t size)
{
	for (size_t b = 0; b < size; b++)
		to[b] = (uint8_t)(bits >> 8 * b);
}

/* One field of some records, whose column has the same type: byte for byte. */
static void copy_field(const las_field *field, const void *from, size_t count, uint8_t *to,
					   size_t stride)
{
	for (size_t i = 0; i < count; i++, to += stride) {
		switch (las_kind_size(field->kind)) {
		case 1:
			*to = ((const uint8_t *)from)[i];
			break;
		case 2:
			store_16(to, ((const uint16_t *)from)[i]);
			break;
		case 4:
			store_32(to, ((const uint32_t *)from)[i]);
			break;
		default:
			store_64(to, ((const uint64_t *)from)[i]);
			break;
		}
	}
}

/* One field of some records, whose column is of another type, but with values that it holds. */
static void convert_field(const writer *w, size_t f, size_t first, size_t count, uint8_t *to)
{
	const las_field *field = &w->layout.field[f];
	const scan_column *column = w->column[f];
	bool color = is_color(field->name), angle = field->kind == LAS_INT16;
	size_t size = las_kind_size(field->kind), stride = w->layout.bytes;
	for (size_t i = first; i < first + count; i++, to += stride) {
		if (field->scaled)
			store_32(to, (uint32_t)las_grid_place(&w->grid[f], scan_value(column, i)));
		else if (color)
			store_16(to, color_value(w, column, i));
		else if (angle && column->type == SCAN_INT8)
			store_16(to, (uint16_t)lrint(scan_value(column, i) / 0.006));
		else if (field->bits)
			*to = (uint8_t)(*to | (unsigned)scan_value(column, i) << field->shift);
		else
			put_bytes(to, (uint64_t)(int64_t)scan_value(column, i), size);
	}
}

/* A point of which nothing is known of returns is the only one of its pulse. */
static void put_records(const writer *w, size_t first, size_t count, uint8_t *records)
{
	size_t stride = w->layout.bytes;
	for (size_t i = 0; i < count && !w->returns; i++)
		records[i * stride + 14] = w->format < 6 ? 1 | 1 << 3 : 1 | 1 << 4;
	for (size_t f = 0; f < w->layout.count; f++) {
		const las_field *field = &w->layout.field[f];
		const scan_column *column = w->column[f];
		uint8_t *to = records + field->place;
		if (!column)
			continue;
		if (field->bits || field->scaled || column->type != las_field_type(field))
			convert_field(w, f, first, count, to);
		else
			copy_field(field, (const char *)column->data + first * scan_type_size(column->type),
					   count, to, stride);
	}
}

static gw_status write_records(writer *w)
{
	size_t record = w->layout.bytes, rows = BLOCK_BYTES / record;
	uint8_t *block = reallocarray(NULL, rows, record);
	if (!block)
		return fail_memory(w);
	gw_status status = GW_OK;
	for (size_t first = 0; first < w->cloud->count && status == GW_OK; first += rows) {
		size_t rest = w->cloud->count - first, count = rest < rows ? rest : rows;
		memset(block, 0, count * record);
		put_records(w, first, count, block);
		status = output_file_write(w->out, block, count * record, w->error);
	}
	free(block);
	return status;
}

/* ------------------------------------------------------------------------------------ VLRs */

/* Content of VLRs to be written. */
typedef struct vlr {
	const char *user;
	uint16_t id;
	uint8_t *data; /* owned */
	size_t length;
} vlr;

enum { VLR_WKT, VLR_KEYS, VLR_DOUBLES, VLR_GEO_TEXT, VLR_TEXT, VLR_EXTRA, VLR_COUNT };

/* Texts end in a zero; what is longer than a VLR is left out, which only a coordinate system of
 * 64 KB would be. */
static gw_status make_text(const writer *w, vlr *v, const char *key)
{
	char *text;
	gw_status status = las_note_join(w->cloud, key, &text, w->error);
	if (status != GW_OK || !text)
		return status;
	v->data = (uint8_t *)text;
	v->length = strlen(text) + 1;
	if (v->length > LENGTH_MAX)
		v->length = 0;
	return GW_OK;
}

/* Numbers of 2 or 8 bytes from text. */
static gw_status make_numbers(const writer *w, vlr *v, const char *key, size_t size)
{
	char *text;
	gw_status status = las_note_join(w->cloud, key, &text, w->error);
	if (status != GW_OK || !text)
		return status;
	size_t length = strlen(text);
	v->data = reallocarray(NULL, length + 1, size);
	if (!v->data) {
		free(text);
		return fail_memory(w);
	}
	for (size_t at = 0, used; at < length && v->length + size <= LENGTH_MAX; at += used + 1) {
		double value;
		used = number_read(text + at, length - at, &value);
		if (used == 0)
			break;
		if (size == 2)
			store_16(v->data + v->length, value >= 0.0 && value <= 65535.0 ? (uint16_t)value : 0);
		else
			store_double(v->data + v->length, value);
		v->length += size;
	}
	free(text);
	return GW_OK;
}

static void add_line(vlr *v, const char *line)
{
	size_t length = strlen(line);
	if (v->length + length + 2 > LENGTH_MAX)
		return;
	memcpy(v->data + v->length, line, length);
	v->length += length;
	v->data[v->length++] = '\n';
}

/* The scan's comments, as lines, but for those that the reader makes. */
static gw_status make_comments(const writer *w, vlr *v)
{
	v->data = malloc(LENGTH_MAX);
	if (!v->data)
		return fail_memory(w);
	for (size_t c = 0; c < w->cloud->comment_count; c++) {
		const char *text = w->cloud->comment[c];
		if (strncmp(text, LAS_NOTE, strlen(LAS_NOTE)) != 0 &&
			strncmp(text, SCAN_NOTE, strlen(SCAN_NOTE)) != 0)
			add_line(v, text);
	}
	static const char axes[3] = "xyz";
	for (int k = 0; k < 3; k++) {
		char line[80], step[NUMBER_TEXT];
		number_print(step, w->grid[k].scale);
		snprintf(line, sizeof line, "glowworm rounded %c to steps of %s", axes[k], step);
		if (!w->grid[k].exact)
			add_line(v, line);
	}
	if (v->length > 0)
		v->data[v->length++] = '\0';
	return GW_OK;
}

static gw_status make_extra(const writer *w, vlr *v)
{
	size_t count = w->layout.count - w->own;
	v->data = calloc(count + 1, LAS_EXTRA_BYTES);
	if (!v->data)
		return fail_memory(w);
	v->length = count * LAS_EXTRA_BYTES;
	for (size_t e = 0; e < count; e++) {
		const las_field *field = &w->layout.field[w->own + e];
		uint8_t *to = v->data + e * LAS_EXTRA_BYTES;
		to[2] = (uint8_t)field->kind;
		memcpy(to + 4, field->name, strnlen(field->name, LAS_EXTRA_NAME));
	}
	return GW_OK;
}

static gw_status make_vlrs(const writer *w, vlr v[VLR_COUNT])
{
	v[VLR_WKT] = (vlr){ .user = LAS_USER_CRS, .id = LAS_VLR_WKT };
	v[VLR_KEYS] = (vlr){ .user = LAS_USER_CRS, .id = LAS_VLR_GEO_KEYS };
	v[VLR_DOUBLES] = (vlr){ .user = LAS_USER_CRS, .id = LAS_VLR_GEO_DOUBLES };
	v[VLR_GEO_TEXT] = (vlr){ .user = LAS_USER_CRS, .id = LAS_VLR_GEO_TEXT };
	v[VLR_TEXT] = (vlr){ .user = LAS_USER_SPEC, .id = LAS_VLR_TEXT };
	v[VLR_EXTRA] = (vlr){ .user = LAS_USER_SPEC, .id = LAS_VLR_EXTRA };
	GW_TRY(make_text(w, &v[VLR_WKT], "wkt"));
	GW_TRY(make_numbers(w, &v[VLR_KEYS], "geokeys", 2));
	GW_TRY(make_numbers(w, &v[VLR_DOUBLES], "geodoubles", 8));
	GW_TRY(make_text(w, &v[VLR_GEO_TEXT], "geotext"));
	GW_TRY(make_comments(w, &v[VLR_TEXT]));
	return make_extra(w, &v[VLR_EXTRA]);
}

static gw_status write_vlrs(writer *w, const vlr v[VLR_COUNT])
{
	for (int k = 0; k < VLR_COUNT; k++) {
		uint8_t head[LAS_VLR_BYTES] = { 0 };
		if (v[k].length == 0)
			continue;
		memcpy(head + 2, v[k].user, strlen(v[k].user));
		store_16(head + 18, v[k].id);
		store_16(head + 20, (uint16_t)v[k].length);
		output_file_write(w->out, head, sizeof head, w->error);
		GW_TRY(output_file_write(w->out, v[k].data, v[k].length, w->error));
	}
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- header */

/* How many points have each return number from 1 to 15. */
static void count_returns(const writer *w, uint64_t count[15])
{
	const scan_column *column = NULL;
	for (size_t f = 0; f < w->own; f++)
		if (strcmp(w->layout.field[f].name, "return_number") == 0)
			column = w->column[f];
	memset(count, 0, 15 * sizeof *count);
	if (!w->returns)
		count[0] = w->cloud->count;
	for (size_t i = 0; column && i < w->cloud->count; i++) {
		double number = scan_value(column, i);
		if (number >= 1.0)
			count[(int)number - 1]++;
	}
}

/* Counts, in 64 bits; the old formats have them in 32 too, when they fit. */
static void put_counts(const writer *w, uint8_t *h)
{
	uint64_t returns[15];
	count_returns(w, returns);
	bool old = w->format < 6 && w->cloud->count <= UINT32_MAX;
	store_64(h + 247, w->cloud->count);
	if (old)
		store_32(h + 107, (uint32_t)w->cloud->count);
	for (size_t r = 0; r < 15; r++) {
		store_64(h + 255 + 8 * r, returns[r]);
		if (old && r < 5)
			store_32(h + 111 + 4 * r, (uint32_t)returns[r]);
	}
}

/* What the input's header said of the file: encoding, source, day, year, system. */
static void put_origin(const writer *w, bool wkt, uint8_t *h)
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

static gw_status write_header(writer *w, const vlr v[VLR_COUNT])
{
	uint8_t h[LAS_HEADER_BYTES_1_4] = { 'L', 'A', 'S', 'F' };
	size_t vlrs = 0, points = sizeof h;
	for (int k = 0; k < VLR_COUNT; k++) {
		vlrs += v[k].length > 0;
		points += v[k].length ? LAS_VLR_BYTES + v[k].length : 0;
	}
	/* New formats name their system by WKT, if any. */
	put_origin(w, v[VLR_WKT].length > 0 || (w->format >= 6 && v[VLR_KEYS].length == 0), h);
	h[24] = 1;
	h[25] = 4;
	store_16(h + 94, sizeof h);
	store_32(h + 96, (uint32_t)points);
	store_32(h + 100, (uint32_t)vlrs);
	h[104] = (uint8_t)w->format;
	store_16(h + 105, (uint16_t)w->layout.bytes);
	for (size_t k = 0; k < 3; k++) {
		store_double(h + 131 + 8 * k, w->grid[k].scale);
		store_double(h + 155 + 8 * k, w->grid[k].offset);
		store_double(h + 179 + 16 * k, w->grid[k].maximum);
		store_double(h + 187 + 16 * k, w->grid[k].minimum);
	}
	put_counts(w, h);
	return output_file_write(w->out, h, sizeof h, w->error);
}

static gw_status write_parts(writer *w, vlr v[VLR_COUNT])
{
	GW_TRY(choose_format(w));
	for (int k = 0; k < 3; k++)
		GW_TRY(las_grid_find(w->cloud, k, output_file_name(w->out), &w->grid[k], w->error));
	GW_TRY(assign_columns(w));
	GW_TRY(make_vlrs(w, v));
	GW_TRY(write_header(w, v));
	GW_TRY(write_vlrs(w, v));
	return write_records(w);
}

static gw_status write_all(writer *w)
{
	vlr v[VLR_COUNT] = { 0 };
	gw_status status = write_parts(w, v);
	for (int k = 0; k < VLR_COUNT; k++)
		free(v[k].data);
	return status;
}

gw_status las_write(output_file *out, const scan *cloud, gw_error *error)
{
	writer w = { .out = out, .cloud = cloud, .error = error };
	gw_status status = write_all(&w);
	las_layout_clear(&w.layout);
	free(w.column);
	return status;
}
