#include "las/las_format.h"
#include "las/las_fields.h"
#include "las/las_flight.h"
#include "las/las_notes.h"
#include "las/laz_reader.h"
#include "files/little_endian.h"
#include "glowworm_host.h"
#include "points/scan_color.h"
#include "points/scan_shift.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Points that one thread takes at a time from an uncompressed file. */
#define BLOCK_POINTS ((size_t)1 << 16)

/* Integers up to here are doubles too. */
#define EXACT ((int64_t)1 << 53)

/* The first of the formats that have LAS_HIGH_NOISE. */
#define FIRST_HIGH_NOISE 6u

typedef struct reader {
	const input_file *in;
	las_header header;
	las_layout layout;
	format_rows rows; /* that are read */
	void **data;      /* for each field its column's values */
	bool *zero;       /* for each field whether it is 0 at all points of the file */
	scan *cloud;
	gw_error *error;
} reader;

/* ----------------------------------------------------------------- from records to columns */

static double load_number(const uint8_t *from, las_kind kind)
{
	uint32_t bits;
	float single;
	switch (kind) {
	case LAS_UINT8:
		return *from;
	case LAS_INT8:
		return (int8_t)*from;
	case LAS_UINT16:
		return load_16(from);
	case LAS_INT16:
		return (int16_t)load_16(from);
	case LAS_UINT32:
		return load_32(from);
	case LAS_INT32:
		return (int32_t)load_32(from);
	case LAS_UINT64:
		return (double)load_64(from);
	case LAS_INT64:
		return (double)(int64_t)load_64(from);
	case LAS_FLOAT32:
		bits = load_32(from);
		memcpy(&single, &bits, sizeof single);
		return (double)single;
	case LAS_FLOAT64:
	case LAS_KIND_COUNT:
		break;
	}
	return load_double(from);
}

/* Columns are zero at first; what is zero is not stored, so that columns of zeros take no memory.
 */
static void take_field(const las_field *field, void *data, size_t first, size_t count,
					   const uint8_t *from, size_t stride)
{
	size_t size = las_kind_size(field->kind);
	unsigned mask = field->bits ? (1u << field->bits) - 1 : 0xff;
	for (size_t i = 0; i < count; i++, from += stride) {
		if (field->scaled) {
			((double *)data)[first + i] =
				load_number(from, field->kind) * field->scale + field->offset;
		} else if (size == 1) {
			uint8_t value = (uint8_t)(*from >> field->shift & mask);
			if (value)
				((uint8_t *)data)[first + i] = value;
		} else if (size == 2) {
			uint16_t value = load_16(from);
			if (value)
				((uint16_t *)data)[first + i] = value;
		} else if (size == 4) {
			uint32_t value = load_32(from);
			if (value)
				((uint32_t *)data)[first + i] = value;
		} else {
			uint64_t value = load_64(from);
			if (value)
				((uint64_t *)data)[first + i] = value;
		}
	}
}

/* first   number of the first one in the file */
static void take_points(void *user, size_t first, size_t count, const uint8_t *records)
{
	const reader *r = user;
	size_t row = first - (size_t)r->rows.first;
	for (size_t f = 0; f < r->layout.count; f++)
		take_field(&r->layout.field[f], r->data[f], row, count, records + r->layout.field[f].place,
				   r->header.record);
}

static void take_block(void *user, size_t first, size_t last, uint32_t worker)
{
	const reader *r = user;
	(void)worker;
	size_t row = (size_t)r->rows.first + first;
	const uint8_t *begin = r->in->data + r->header.points + row * r->header.record;
	take_points(user, row, last - first, begin);
	input_file_discard(r->in, begin, begin + (last - first) * r->header.record);
}

/* The system would promise more than it has, and then end us. Columns that may stay zero count as
 * nothing. */
static gw_status check_memory(const reader *r)
{
	uint64_t bytes = 0, wanted, available = gw_available_memory();
	for (size_t f = 0; f < r->layout.count; f++)
		if (!r->layout.field[f].optional)
			bytes += scan_type_size(las_field_type(&r->layout.field[f]));
	if (__builtin_mul_overflow(bytes, r->cloud->count, &wanted))
		wanted = UINT64_MAX;
	if (available && wanted > available)
		return gw_fail(r->error, GW_ERROR_MEMORY,
					   "%s: %zu points take %.1f GB, but only %.1f GB of memory are available",
					   r->in->name, r->cloud->count, (double)wanted * 1e-9,
					   (double)available * 1e-9);
	return GW_OK;
}

static gw_status add_columns(reader *r)
{
	GW_TRY(check_memory(r));
	r->data = calloc(r->layout.count, sizeof *r->data);
	if (!r->data)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the fields of %s", r->in->name);
	for (size_t f = 0; f < r->layout.count; f++) {
		const las_field *field = &r->layout.field[f];
		scan_column *column =
			scan_add_column(r->cloud, field->name, las_field_type(field), r->error);
		if (!column)
			return GW_ERROR_MEMORY;
		r->data[f] = column->data;
	}
	return GW_OK;
}

static gw_status read_plain(reader *r)
{
	const las_header *h = &r->header;
	uint64_t there = (r->in->length - h->points) / h->record;
	if (h->count > there)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s: the header counts %" PRIu64
					   " points of %zu bytes, but from byte %zu on "
					   "there is room for %" PRIu64 "; the file is cut short or damaged",
					   r->in->name, h->count, h->record, h->points, there);
	GW_TRY(add_columns(r));
	gw_parallel_for(r->in->threads, r->cloud->count, BLOCK_POINTS, take_block, r);
	return GW_OK;
}

static gw_status read_compressed(reader *r)
{
	laz_stream *stream;
	GW_TRY(laz_open(&stream, r->in, &r->header, r->error));
	gw_status status = add_columns(r);
	if (status == GW_OK)
		status = laz_decode(stream, &r->rows, take_points, r, r->error);
	laz_close(&stream);
	return status;
}

/* ------------------------------------------------------------------ what is found afterwards */

/* Whether a field holds nothing; also one that is not there. */
static bool is_zero(const reader *r, const char *name)
{
	for (size_t f = 0; f < r->layout.count; f++)
		if (strcmp(r->layout.field[f].name, name) == 0)
			return r->zero[f];
	return true;
}

static gw_status allocate_zero(reader *r)
{
	r->zero = calloc(r->layout.count, sizeof *r->zero);
	return r->zero
			   ? GW_OK
			   : gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the fields of %s", r->in->name);
}

/* As long as columns are those of the fields. */
static gw_status find_zeros(reader *r)
{
	GW_TRY(allocate_zero(r));
	for (size_t f = 0; f < r->layout.count; f++)
		r->zero[f] = scan_is_zero(&r->cloud->column[f], r->cloud->count);
	return GW_OK;
}

/* Integers of 64 bits become doubles, or when those cannot hold them two columns of 32 bits. */
static gw_status settle_wide(reader *r, const las_field *field)
{
	scan_column *column = scan_find(r->cloud, field->name);
	uint64_t *bits = column->data;
	bool exact = true, negative = field->kind == LAS_INT64;
	for (size_t i = 0; i < r->cloud->count && exact; i++)
		exact = negative ? (int64_t)bits[i] <= EXACT && (int64_t)bits[i] >= -EXACT
						 : bits[i] <= (uint64_t)EXACT;
	if (exact) {
		for (size_t i = 0; i < r->cloud->count; i++) {
			double value = negative ? (double)(int64_t)bits[i] : (double)bits[i];
			memcpy(&bits[i], &value, sizeof value);
		}
		return GW_OK;
	}
	char name[2][LAS_COLUMN_NAME + 8];
	for (int half = 0; half < 2; half++) {
		snprintf(name[half], sizeof *name, "%s_%s", field->name, half ? "high" : "low");
		scan_column *to = scan_add_column(r->cloud, name[half], SCAN_UINT32, r->error);
		if (!to)
			return GW_ERROR_MEMORY;
		bits = scan_find(r->cloud, field->name)->data;
		for (size_t i = 0; i < r->cloud->count; i++)
			((uint32_t *)to->data)[i] = (uint32_t)(bits[i] >> 32 * half);
	}
	scan_remove_column(r->cloud, field->name);
	return las_note(r->cloud, r->error, "the 64 bits of '%s' come as '%s' and '%s'", field->name,
					name[0], name[1]);
}

/* An extra value called like a field that holds nothing takes its place. */
static gw_status take_place(reader *r, const las_field *field)
{
	scan_column *column = scan_find(r->cloud, field->name);
	if (!column || !is_zero(r, field->standard))
		return GW_OK;
	char *name = strdup(field->standard);
	if (!name)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the columns of %s", r->in->name);
	scan_remove_column(r->cloud, field->standard);
	column = scan_find(r->cloud, field->name);
	free(column->name);
	column->name = name;
	return GW_OK;
}

/* Colours that are zero at all points are a scanner without a camera. */
static gw_status settle_colors(reader *r)
{
	for (int k = 0; k < 3; k++)
		if (!scan_find(r->cloud, scan_color_names[k]) || r->cloud->count == 0 ||
			!is_zero(r, scan_color_names[k]))
			return GW_OK;
	for (int k = 0; k < 3; k++)
		scan_remove_column(r->cloud, scan_color_names[k]);
	return las_note(r->cloud, r->error, "all colours are zero, which counts as none");
}

static gw_status settle_columns(reader *r)
{
	const las_layout *layout = &r->layout;
	GW_TRY(settle_colors(r));
	for (size_t f = 0; f < layout->count; f++) {
		const las_field *field = &layout->field[f];
		const scan_column *column = scan_find(r->cloud, field->name);
		if (field->optional && column && r->zero[f])
			scan_remove_column(r->cloud, field->name);
		else if (column && !field->scaled &&
				 (field->kind == LAS_UINT64 || field->kind == LAS_INT64))
			GW_TRY(settle_wide(r, field));
		if (field->standard[0])
			GW_TRY(take_place(r, field));
	}
	return GW_OK;
}

/* Says so when the header's bounds are not those of the points. Half a step may be lost where a
 * writer printed and read the bounds. */
static gw_status check_bounds(reader *r, const double minimum[3], const double maximum[3])
{
	const las_header *h = &r->header;
	double worst = 0.0, allowed = 0.0;
	if (!(minimum[0] <= maximum[0]))
		return GW_OK;
	for (size_t k = 0; k < 3; k++) {
		double low = minimum[k], high = maximum[k];
		double off = fmax(fabs(low - h->minimum[k]), fabs(high - h->maximum[k]));
		worst = off <= worst ? worst : off;
		allowed = fmax(allowed, fabs(h->scale[k]) + 1e-12 * fmax(fabs(low), fabs(high)));
	}
	if (worst <= allowed)
		return GW_OK;
	return las_note(r->cloud, r->error,
					"the header's bounds are wrong by up to %s; those of the points hold",
					GW_SAID_PLACE(worst));
}

/* What stands before the points.
 *   notes   receives comments */
static gw_status read_head(reader *r, scan *notes)
{
	GW_TRY(las_header_parse(&r->header, r->in, notes, r->error));
	GW_TRY(
		las_layout_make(&r->layout, r->header.format, r->header.scale, r->header.offset, r->error));
	return las_layout_add_extra(&r->layout, &r->header, notes, r->error);
}

/* Points that an old format had keep their angle in degrees, and the meaning of their classes. */
static bool has_high_noise(const reader *r)
{
	bool high = r->header.format >= FIRST_HIGH_NOISE;
	for (size_t f = 0; f < r->layout.count && high; f++)
		high = strcmp(r->layout.field[f].name, "scan_angle_rank") != 0;
	return high;
}

/* Those of the rows that are there, as they stand. */
static gw_status read_points(reader *r, const format_rows *rows)
{
	GW_TRY(read_head(r, r->cloud));
	uint64_t count = r->header.count, first = rows->first < count ? rows->first : count;
	r->rows = (format_rows){ first, rows->count < count - first ? rows->count : count - first };
	r->cloud->count = (size_t)r->rows.count;
	r->cloud->noise_classes = has_high_noise(r) ? LAS_LOW_NOISE | LAS_HIGH_NOISE : LAS_LOW_NOISE;
	return r->header.compressed ? read_compressed(r) : read_plain(r);
}

static gw_status read_all(reader *r)
{
	GW_TRY(read_points(r, &(format_rows){ 0, UINT64_MAX }));
	GW_TRY(find_zeros(r));
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	scan_shift_bounds(r->cloud, low, high);
	GW_TRY(check_bounds(r, low, high));
	GW_TRY(settle_columns(r));
	return las_flight_find(r->cloud, r->error);
}

static gw_status finish(reader *r, gw_status status)
{
	las_layout_clear(&r->layout);
	free(r->data);
	free(r->zero);
	if (status != GW_OK)
		scan_clear(r->cloud);
	return status;
}

gw_status las_read(input_file *in, scan *cloud, gw_error *error)
{
	*cloud = (scan){ .up = 'z' };
	reader r = { .in = in, .cloud = cloud, .error = error };
	return finish(&r, read_all(&r));
}

/* ------------------------------------------------------------------------------------ in parts */

/* What a field becomes has to be known without its values. */
static bool has_plain_fields(const las_layout *layout)
{
	bool plain = true;
	for (size_t f = 0; f < layout->count; f++) {
		const las_field *field = &layout->field[f];
		bool wide = field->kind == LAS_UINT64 || field->kind == LAS_INT64;
		plain = plain && !field->standard[0] && (field->scaled || !wide) &&
				!scan_color_may_be_packed(field->name);
	}
	return plain;
}

/* 0 where they are not all there. */
static uint64_t points_together(const reader *r)
{
	const las_header *h = &r->header;
	laz_stream *stream;
	if (!h->compressed)
		return h->points <= r->in->length && (r->in->length - h->points) / h->record >= h->count;
	if (laz_open(&stream, r->in, h, r->error) != GW_OK)
		return 0;
	uint64_t together = laz_chunk_points(stream);
	laz_close(&stream);
	return together;
}

uint64_t las_count_rows(input_file *in, uint64_t *together)
{
	scan notes = { 0 };
	gw_error ignored = { 0 };
	reader r = { .in = in, .cloud = &notes, .error = &ignored };
	*together = 0;
	if (read_head(&r, &notes) == GW_OK && has_plain_fields(&r.layout))
		*together = points_together(&r);
	scan_clear(&notes);
	finish(&r, GW_OK);
	return *together > 0 ? r.header.count : 0;
}

bool las_say_bounds(input_file *in, double minimum[3], double maximum[3])
{
	scan notes = { 0 };
	gw_error ignored = { 0 };
	las_header header;
	bool good = las_header_parse(&header, in, &notes, &ignored) == GW_OK;
	for (int k = 0; good && k < 3; k++) {
		minimum[k] = header.minimum[k];
		maximum[k] = header.maximum[k];
		good = isfinite(minimum[k]) && isfinite(maximum[k]) && minimum[k] <= maximum[k];
	}
	scan_clear(&notes);
	return good;
}

gw_status las_read_rows(input_file *in, const format_rows *rows, scan *cloud, gw_error *error)
{
	*cloud = (scan){ .up = 'z' };
	reader r = { .in = in, .cloud = cloud, .error = error };
	return finish(&r, read_points(&r, rows));
}

static gw_status settle_rows(reader *r, const format_seen *seen)
{
	scan notes = { 0 };
	gw_status status = read_head(r, &notes);
	scan_clear(&notes);
	GW_TRY(status);
	GW_TRY(allocate_zero(r));
	for (size_t f = 0; f < r->layout.count; f++) {
		const scan_column *column = scan_find(r->cloud, r->layout.field[f].name);
		r->zero[f] = column && seen->zero[column - r->cloud->column];
	}
	GW_TRY(check_bounds(r, seen->minimum, seen->maximum));
	GW_TRY(settle_columns(r));
	return las_flight_find(r->cloud, r->error);
}

gw_status las_settle_rows(input_file *in, const format_seen *seen, scan *kept, gw_error *error)
{
	reader r = { .in = in, .cloud = kept, .error = error };
	return finish(&r, settle_rows(&r, seen));
}
