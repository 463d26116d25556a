#include "las/las_records.h"
#include "las/las_notes.h"
#include "files/little_endian.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of a record of formats 6 to 10. */
enum { LAS_NEW_FLAGS = 15, LAS_NEW_CLASS = 16 };

/* ------------------------------------------------------------------- which column goes where */

/* True when all columns that are called like fields of the old formats go there, and none needs a
 * field that only new ones have. */
static bool fits_old(const las_records *w, const las_survey *survey)
{
	static const char *const only_new[] = { "scan_angle", "overlap", "scanner_channel", "nir" };
	if (!scan_find(w->cloud, "scan_angle_rank"))
		return false;
	for (size_t i = 0; i < sizeof only_new / sizeof *only_new; i++)
		if (scan_find(w->cloud, only_new[i]))
			return false;
	const las_layout *old = &survey->layout[LAS_OLD];
	for (size_t f = 3; f < old->count; f++) {
		const las_field *field = &old->field[f];
		const scan_column *column = scan_find(w->cloud, field->name);
		if (column && !las_field_is_color(field->name) &&
			!las_survey_fits(survey, LAS_OLD, field, column))
			return false;
	}
	return true;
}

/* What colours count to. Bytes that the survey did not have are a preview of the light. */
static bool find_color(las_records *w, const las_survey *survey)
{
	if (!scan_find(w->cloud, "red") || !scan_find(w->cloud, "green") ||
		!scan_find(w->cloud, "blue") || !scan_color_find(w->cloud, scan_color_names, &w->color))
		return false;
	const scan_column *albedo[3];
	bool bytes = true;
	for (int k = 0; k < 3; k++)
		bytes = bytes && scan_type_size(w->color.column[k]->type) == 1;
	if (!bytes && survey->color.count > 0)
		scan_color_tally_settle(&survey->color, &w->color);
	w->preview = bytes && scan_find_triple(w->cloud, scan_albedo_names, albedo);
	return true;
}

/* Formats 6 to 8 are what LAS 1.4 is for; points that come from an old format keep it, because a
 * scan angle in degrees and one in steps of 0.006 degrees are different numbers. */
static void choose_format(las_records *w, const las_survey *survey, bool newer)
{
	bool time = scan_find(w->cloud, "gps_time") != NULL;
	w->returns = scan_find(w->cloud, "return_number") || scan_find(w->cloud, "number_of_returns");
	w->colored = find_color(w, survey);
	w->format = (time ? 1u : 0u) + (w->colored ? 2u : 0u);
	if (newer || !fits_old(w, survey))
		w->format = scan_find(w->cloud, "nir") ? 8 : w->colored ? 7 : 6;
	w->legacy = w->format >= 6 && las_note_legacy(w->cloud);
}

static bool is_written(const las_records *w, const char *name)
{
	for (size_t f = 0; f < w->own; f++)
		if (w->column[f] && strcmp(w->layout.field[f].name, name) == 0)
			return true;
	return false;
}

/* An extra value's name has 32 bytes: longer ones are cut, and numbered when that makes two
 * alike; the head has them whole. */
static void name_extra(const las_records *w, las_field *field, const char *name)
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

static gw_status add_extra(las_records *w, const scan_column *column, gw_error *error)
{
	static const las_kind kind[SCAN_TYPE_COUNT] = {
		[SCAN_INT8] = LAS_INT8,       [SCAN_UINT8] = LAS_UINT8,     [SCAN_INT16] = LAS_INT16,
		[SCAN_UINT16] = LAS_UINT16,   [SCAN_INT32] = LAS_INT32,     [SCAN_UINT32] = LAS_UINT32,
		[SCAN_FLOAT32] = LAS_FLOAT32, [SCAN_FLOAT64] = LAS_FLOAT64,
	};
	las_field field = { .kind = kind[column->type], .place = w->layout.bytes };
	name_extra(w, &field, column->name);
	size_t extras = w->layout.count - w->own + 1;
	if (extras * LAS_EXTRA_BYTES > LAS_LENGTH_MAX ||
		w->layout.bytes + las_kind_size(field.kind) > LAS_LENGTH_MAX)
		return gw_fail(
			error, GW_ERROR_DATA,
			"%s: the points have more columns than LAS holds, of which %zu are no fields "
			"of its points; write PLY",
			w->name, extras);
	w->column[w->layout.count] = column;
	return las_layout_add(&w->layout, &field, error);
}

/* An angle of the old formats, in degrees, for the new ones; it also stays as it is. */
static const scan_column *find_rank(const scan *cloud)
{
	const scan_column *rank = scan_find(cloud, "scan_angle_rank");
	return rank && rank->type == SCAN_INT8 ? rank : NULL;
}

/* Points of a class that new formats have a flag for in its place. */
static void flag_overlap(const las_records *w, size_t count, uint8_t *bytes)
{
	size_t stride = w->layout.bytes;
	for (uint8_t *at = bytes; count > 0; count--, at += stride)
		if (at[LAS_NEW_CLASS] == LAS_CLASS_OVERLAP) {
			at[LAS_NEW_CLASS] = 0;
			at[LAS_NEW_FLAGS] |= 1u << 3;
		}
}

static gw_status assign_columns(las_records *w, const las_survey *survey, gw_error *error)
{
	const double scale[3] = { w->grid[0].scale, w->grid[1].scale, w->grid[2].scale };
	const double offset[3] = { w->grid[0].offset, w->grid[1].offset, w->grid[2].offset };
	GW_TRY(las_layout_make(&w->layout, w->format, scale, offset, error));
	w->own = w->layout.count;
	w->column = calloc(w->own + w->cloud->column_count, sizeof *w->column);
	if (!w->column)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", w->name);
	for (size_t f = 0; f < w->own; f++) {
		const las_field *field = &w->layout.field[f];
		const scan_column *column = scan_find(w->cloud, field->name);
		bool taken =
			las_field_is_color(field->name)
				? w->colored
				: field->scaled || !column ||
					  las_survey_fits(survey, w->format < 6 ? LAS_OLD : LAS_NEW, field, column);
		w->column[f] = taken ? column : NULL;
		if (strcmp(field->name, "scan_angle") == 0 && !column)
			w->column[f] = find_rank(w->cloud);
	}
	for (size_t c = 0; c < w->cloud->column_count; c++)
		if (!is_written(w, w->cloud->column[c].name))
			GW_TRY(add_extra(w, &w->cloud->column[c], error));
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- records */

static uint16_t color_value(const las_records *w, const scan_column *column, size_t i)
{
	int channel = 0;
	while (w->color.column[channel] != column && channel < 2)
		channel++;
	double value = scan_color_value(&w->color, channel, i);
	if (w->preview)
		return (uint16_t)((unsigned)(value * 255.0 + 0.5) << 8);
	return value > 0.0 ? (uint16_t)(fmin(value, 1.0) * 65535.0 + 0.5) : 0;
}

static void put_bytes(uint8_t *to, uint64_t bits, size_t size)
{
	for (size_t b = 0; b < size; b++)
		to[b] = (uint8_t)(bits >> 8 * b);
}

/* One field of records, whose column has the same type: byte for byte. */
static void copy_field(const las_records *w, size_t f, size_t first, size_t count, uint8_t *to)
{
	const void *from = w->column[f]->data;
	size_t size = las_kind_size(w->layout.field[f].kind), stride = w->layout.bytes;
	for (size_t i = first; i < first + count; i++, to += stride) {
		size_t row = w->order ? w->order[i] : i;
		switch (size) {
		case 1:
			*to = ((const uint8_t *)from)[row];
			break;
		case 2:
			store_16(to, ((const uint16_t *)from)[row]);
			break;
		case 4:
			store_32(to, ((const uint32_t *)from)[row]);
			break;
		default:
			store_64(to, ((const uint64_t *)from)[row]);
			break;
		}
	}
}

/* One field of records, whose column is of another type, but with values that it holds. */
static void convert_field(const las_records *w, size_t f, size_t first, size_t count, uint8_t *to)
{
	const las_field *field = &w->layout.field[f];
	const scan_column *column = w->column[f];
	bool color = las_field_is_color(field->name), angle = field->kind == LAS_INT16;
	size_t size = las_kind_size(field->kind), stride = w->layout.bytes;
	for (size_t i = first; i < first + count; i++, to += stride) {
		size_t row = w->order ? w->order[i] : i;
		if (field->scaled)
			store_32(to, (uint32_t)las_grid_place(&w->grid[f], scan_value(column, row)));
		else if (color)
			store_16(to, color_value(w, column, row));
		else if (angle && column->type == SCAN_INT8)
			store_16(to, (uint16_t)lrint(scan_value(column, row) / 0.006));
		else if (field->bits)
			*to = (uint8_t)(*to | (unsigned)scan_value(column, row) << field->shift);
		else
			put_bytes(to, (uint64_t)(int64_t)scan_value(column, row), size);
	}
}

/* A point of which nothing is known of returns is the only one of its pulse. */
void las_records_put(const las_records *w, size_t first, size_t count, uint8_t *bytes)
{
	size_t stride = w->layout.bytes;
	if (w->made) {
		memcpy(bytes, w->made + first * stride, count * stride);
		return;
	}
	memset(bytes, 0, count * stride);
	for (size_t i = 0; i < count && !w->returns; i++)
		bytes[i * stride + 14] = w->format < 6 ? 1 | 1 << 3 : 1 | 1 << 4;
	for (size_t f = 0; f < w->layout.count; f++) {
		const las_field *field = &w->layout.field[f];
		const scan_column *column = w->column[f];
		if (!column)
			continue;
		if (field->bits || field->scaled || column->type != las_field_type(field))
			convert_field(w, f, first, count, bytes + field->place);
		else
			copy_field(w, f, first, count, bytes + field->place);
	}
	if (w->legacy)
		flag_overlap(w, count, bytes);
}

/* ----------------------------------------------------------------------------- the whole */

/* A point of which nothing is known of returns is the only one. */
static void count_returns(las_records *w, const las_survey *survey)
{
	const scan_column *column = NULL;
	for (size_t f = 0; f < w->own; f++)
		if (strcmp(w->layout.field[f].name, "return_number") == 0)
			column = w->column[f];
	w->total = survey->count;
	if (!w->returns)
		w->returned[0] = survey->count;
	if (column)
		memcpy(w->returned, survey->returns, sizeof w->returned);
}

gw_status las_records_of_part(las_records *w, const las_survey *survey, const scan *part,
							  bool newer, gw_error *error)
{
	*w = (las_records){ .name = survey->name, .cloud = part, .count = part->count };
	choose_format(w, survey, newer);
	for (int k = 0; k < 3; k++)
		GW_TRY(las_grid_search_take(&survey->axis[k], part->step, k, w->name, &w->grid[k], error));
	GW_TRY(assign_columns(w, survey, error));
	count_returns(w, survey);
	return GW_OK;
}

gw_status las_records_make(las_records *w, const scan *cloud, const char *name, bool newer,
						   gw_error *error)
{
	las_survey survey;
	*w = (las_records){ .name = name };
	gw_status status = las_survey_begin(&survey, name, error);
	if (status == GW_OK)
		status = las_survey_all(&survey, cloud, error);
	if (status == GW_OK)
		status = las_records_of_part(w, &survey, cloud, newer, error);
	las_survey_clear(&survey);
	return status;
}

void las_records_clear(las_records *w)
{
	las_layout_clear(&w->layout);
	free(w->column);
	*w = (las_records){ 0 };
}
