#include "las/las_fields.h"
#include "files/growing_table.h"
#include "las/las_notes.h"
#include "files/little_endian.h"

#include <stdio.h>
#include <string.h>

/* Bytes that nothing describes become a column each, up to this number. */
#define UNKNOWN_BYTES 64

/* The longest name that a number has room behind. */
#define NAME_MOST (LAS_COLUMN_NAME - 16)

size_t las_kind_size(las_kind kind)
{
	static const size_t size[LAS_KIND_COUNT] = {
		[LAS_UINT8] = 1, [LAS_INT8] = 1,   [LAS_UINT16] = 2, [LAS_INT16] = 2,   [LAS_UINT32] = 4,
		[LAS_INT32] = 4, [LAS_UINT64] = 8, [LAS_INT64] = 8,  [LAS_FLOAT32] = 4, [LAS_FLOAT64] = 8,
	};
	return size[kind];
}

scan_type las_field_type(const las_field *field)
{
	static const scan_type type[LAS_KIND_COUNT] = {
		[LAS_UINT8] = SCAN_UINT8,     [LAS_INT8] = SCAN_INT8,     [LAS_UINT16] = SCAN_UINT16,
		[LAS_INT16] = SCAN_INT16,     [LAS_UINT32] = SCAN_UINT32, [LAS_INT32] = SCAN_INT32,
		[LAS_UINT64] = SCAN_FLOAT64,  [LAS_INT64] = SCAN_FLOAT64, [LAS_FLOAT32] = SCAN_FLOAT32,
		[LAS_FLOAT64] = SCAN_FLOAT64,
	};
	return field->scaled ? SCAN_FLOAT64 : type[field->kind];
}

bool las_field_is_color(const char *name)
{
	return strcmp(name, "red") == 0 || strcmp(name, "green") == 0 || strcmp(name, "blue") == 0;
}

gw_status las_layout_add(las_layout *layout, const las_field *field, gw_error *error)
{
	las_field *grown = growing_table_room(layout->field, layout->count, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the fields of LAS points");
	layout->field = grown;
	layout->field[layout->count++] = *field;
	size_t end = field->place + las_kind_size(field->kind);
	layout->bytes = end > layout->bytes ? end : layout->bytes;
	return GW_OK;
}

static gw_status add_fields(las_layout *layout, const las_field *field, size_t count, size_t shift,
							gw_error *error)
{
	for (size_t i = 0; i < count; i++) {
		las_field moved = field[i];
		moved.place += shift;
		GW_TRY(las_layout_add(layout, &moved, error));
	}
	return GW_OK;
}

/* --------------------------------------------------------------------- fields of a format */

static const las_field position_fields[] = {
	{ .name = "x", .kind = LAS_INT32, .place = 0, .scaled = true },
	{ .name = "y", .kind = LAS_INT32, .place = 4, .scaled = true },
	{ .name = "z", .kind = LAS_INT32, .place = 8, .scaled = true },
};

/* Of formats 0 to 5. */
static const las_field old_fields[] = {
	{ .name = "intensity", .kind = LAS_UINT16, .place = 12 },
	{ .name = "return_number", .kind = LAS_UINT8, .place = 14, .shift = 0, .bits = 3 },
	{ .name = "number_of_returns", .kind = LAS_UINT8, .place = 14, .shift = 3, .bits = 3 },
	{ .name = "scan_direction_flag",
	  .kind = LAS_UINT8,
	  .place = 14,
	  .shift = 6,
	  .bits = 1,
	  .optional = true },
	{ .name = "edge_of_flight_line",
	  .kind = LAS_UINT8,
	  .place = 14,
	  .shift = 7,
	  .bits = 1,
	  .optional = true },
	{ .name = "classification", .kind = LAS_UINT8, .place = 15, .shift = 0, .bits = 5 },
	{ .name = "synthetic",
	  .kind = LAS_UINT8,
	  .place = 15,
	  .shift = 5,
	  .bits = 1,
	  .optional = true },
	{ .name = "key_point",
	  .kind = LAS_UINT8,
	  .place = 15,
	  .shift = 6,
	  .bits = 1,
	  .optional = true },
	{ .name = "withheld", .kind = LAS_UINT8, .place = 15, .shift = 7, .bits = 1, .optional = true },
	{ .name = "scan_angle_rank", .kind = LAS_INT8, .place = 16 },
	{ .name = "user_data", .kind = LAS_UINT8, .place = 17 },
	{ .name = "point_source_id", .kind = LAS_UINT16, .place = 18 },
};

/* Of formats 6 to 10. The scan angle counts steps of 0.006 degrees. */
static const las_field new_fields[] = {
	{ .name = "intensity", .kind = LAS_UINT16, .place = 12 },
	{ .name = "return_number", .kind = LAS_UINT8, .place = 14, .shift = 0, .bits = 4 },
	{ .name = "number_of_returns", .kind = LAS_UINT8, .place = 14, .shift = 4, .bits = 4 },
	{ .name = "synthetic",
	  .kind = LAS_UINT8,
	  .place = 15,
	  .shift = 0,
	  .bits = 1,
	  .optional = true },
	{ .name = "key_point",
	  .kind = LAS_UINT8,
	  .place = 15,
	  .shift = 1,
	  .bits = 1,
	  .optional = true },
	{ .name = "withheld", .kind = LAS_UINT8, .place = 15, .shift = 2, .bits = 1, .optional = true },
	{ .name = "overlap", .kind = LAS_UINT8, .place = 15, .shift = 3, .bits = 1, .optional = true },
	{ .name = "scanner_channel",
	  .kind = LAS_UINT8,
	  .place = 15,
	  .shift = 4,
	  .bits = 2,
	  .optional = true },
	{ .name = "scan_direction_flag",
	  .kind = LAS_UINT8,
	  .place = 15,
	  .shift = 6,
	  .bits = 1,
	  .optional = true },
	{ .name = "edge_of_flight_line",
	  .kind = LAS_UINT8,
	  .place = 15,
	  .shift = 7,
	  .bits = 1,
	  .optional = true },
	{ .name = "classification", .kind = LAS_UINT8, .place = 16 },
	{ .name = "user_data", .kind = LAS_UINT8, .place = 17 },
	{ .name = "scan_angle", .kind = LAS_INT16, .place = 18 },
	{ .name = "point_source_id", .kind = LAS_UINT16, .place = 20 },
};

static const las_field time_fields[] = { { .name = "gps_time", .kind = LAS_FLOAT64 } };

/* The last one is only in formats 8 and 10. */
static const las_field color_fields[] = {
	{ .name = "red", .kind = LAS_UINT16, .place = 0 },
	{ .name = "green", .kind = LAS_UINT16, .place = 2 },
	{ .name = "blue", .kind = LAS_UINT16, .place = 4 },
	{ .name = "nir", .kind = LAS_UINT16, .place = 6 },
};

static const las_field wave_fields[] = {
	{ .name = "wave_descriptor", .kind = LAS_UINT8, .place = 0 },
	{ .name = "wave_offset", .kind = LAS_UINT64, .place = 1 },
	{ .name = "wave_size", .kind = LAS_UINT32, .place = 9 },
	{ .name = "wave_return_point", .kind = LAS_FLOAT32, .place = 13 },
	{ .name = "wave_dx", .kind = LAS_FLOAT32, .place = 17 },
	{ .name = "wave_dy", .kind = LAS_FLOAT32, .place = 21 },
	{ .name = "wave_dz", .kind = LAS_FLOAT32, .place = 25 },
};

#define LENGTH(table) (sizeof(table) / sizeof *(table))

static gw_status add_format(las_layout *layout, unsigned format, gw_error *error)
{
	bool old = format < 6;
	bool time = format != 0 && format != 2;
	bool color =
		format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
	bool infrared = format == 8 || format == 10;
	bool wave = format == 4 || format == 5 || format == 9 || format == 10;
	GW_TRY(add_fields(layout, old ? old_fields : new_fields,
					  old ? LENGTH(old_fields) : LENGTH(new_fields), 0, error));
	if (time)
		GW_TRY(add_fields(layout, time_fields, LENGTH(time_fields), layout->bytes, error));
	if (color)
		GW_TRY(add_fields(layout, color_fields, infrared ? 4 : 3, layout->bytes, error));
	if (wave)
		GW_TRY(add_fields(layout, wave_fields, LENGTH(wave_fields), layout->bytes, error));
	return GW_OK;
}

gw_status las_layout_make(las_layout *layout, unsigned format, const double *scale,
						  const double *offset, gw_error *error)
{
	*layout = (las_layout){ 0 };
	gw_status status = add_fields(layout, position_fields, 3, 0, error);
	for (size_t k = 0; k < 3 && status == GW_OK; k++) {
		layout->field[k].scale = scale[k];
		layout->field[k].offset = offset[k];
	}
	if (status == GW_OK)
		status = add_format(layout, format, error);
	if (status != GW_OK)
		las_layout_clear(layout);
	return status;
}

void las_layout_clear(las_layout *layout)
{
	free(layout->field);
	*layout = (las_layout){ 0 };
}

/* ---------------------------------------------------------------------------- extra bytes */

static const las_field *find(const las_layout *layout, const char *name)
{
	for (size_t i = 0; i < layout->count; i++)
		if (strcmp(layout->field[i].name, name) == 0)
			return &layout->field[i];
	return NULL;
}

/* Gives a field its name, or one with a number behind it when that is taken. */
static void name_field(const las_layout *layout, las_field *field, const char *name)
{
	snprintf(field->name, sizeof field->name, "%.*s", NAME_MOST, name);
	const las_field *other = find(layout, field->name);
	if (other && strlen(name) < sizeof field->standard)
		memcpy(field->standard, name, strlen(name) + 1);
	for (unsigned n = 2; find(layout, field->name); n++)
		snprintf(field->name, sizeof field->name, "%.*s_%u", NAME_MOST, name, n);
}

/* Names that other programs use, and ours. */
static const char *canonical(const char *name)
{
	static const char *const same[][2] = { { "NormalX", "nx" },  { "NormalY", "ny" },
										   { "NormalZ", "nz" },  { "normal_x", "nx" },
										   { "normal_y", "ny" }, { "normal_z", "nz" } };
	for (size_t i = 0; i < LENGTH(same); i++)
		if (strcmp(name, same[i][0]) == 0)
			return same[i][1];
	return name;
}

static void copy_name(char name[LAS_EXTRA_NAME + 1], const uint8_t *from)
{
	size_t length = strnlen((const char *)from, LAS_EXTRA_NAME);
	for (size_t i = 0; i < length; i++)
		name[i] = from[i] >= ' ' && from[i] <= '~' ? (char)from[i] : '_';
	name[length] = '\0';
	while (length > 0 && name[length - 1] == ' ')
		name[--length] = '\0';
	if (length == 0)
		memcpy(name, "extra", sizeof "extra");
}

/* What is added to, and of which file. */
typedef struct extras {
	las_layout *layout;
	const las_header *header;
	scan *notes;
	gw_error *error;
} extras;

/* The whole name of an extra value that the file has in its text record; false: none, as its own is
 * whole, or another program left it out. */
static bool find_whole_name(const las_vlr *text, const uint8_t *own, char name[LAS_COLUMN_NAME])
{
	const char *lines = (const char *)text->data;
	size_t cut = strnlen((const char *)own, LAS_EXTRA_NAME), length = 0;
	char start[sizeof LAS_COLUMN_LINE LAS_COLUMN_IS + LAS_EXTRA_NAME];
	int size = snprintf(start, sizeof start, LAS_COLUMN_LINE "%.*s" LAS_COLUMN_IS, (int)cut,
						(const char *)own);
	size_t rest = lines ? strnlen(lines, text->length) : 0;
	for (; rest > 0; lines += length, rest -= length) {
		const char *end = memchr(lines, '\n', rest);
		length = end ? (size_t)(end - lines) + 1 : rest;
		if (length > (size_t)size && strncmp(lines, start, (size_t)size) == 0)
			break;
	}
	size_t used = 0;
	for (size_t i = (size_t)size; rest > 0 && i < length && lines[i] != '\n'; i++)
		if (used < LAS_COLUMN_NAME - 1)
			name[used++] = lines[i] >= ' ' && lines[i] <= '~' ? lines[i] : '_';
	name[used] = '\0';
	return used > 0;
}

/* One value of a description; those with several (types 11 to 30, deprecated) are numbered. */
static gw_status add_value(const extras *x, const uint8_t *from, las_kind kind, size_t index,
						   size_t values)
{
	char own[LAS_EXTRA_NAME + 1], name[LAS_COLUMN_NAME];
	copy_name(own, from + 4);
	if (values > 1)
		snprintf(name, sizeof name, "%s_%zu", own, index);
	else if (!find_whole_name(&x->header->text, from + 4, name))
		snprintf(name, sizeof name, "%s", canonical(own));
	las_field field = { .kind = kind, .place = x->layout->bytes, .scale = 1.0 };
	uint8_t options = from[3];
	if (options & 8)
		field.scale = load_double(from + 112 + 8 * (index < 3 ? index : 0));
	if (options & 16)
		field.offset = load_double(from + 136 + 8 * (index < 3 ? index : 0));
	field.scaled = field.scale != 1.0 || field.offset != 0.0;
	name_field(x->layout, &field, name);
	return las_layout_add(x->layout, &field, x->error);
}

/* Bytes without a type: each is a column, as long as there are few. */
static gw_status add_bytes(const extras *x, const uint8_t *from, size_t count)
{
	static const uint8_t nameless[LAS_EXTRA_BYTES];
	uint8_t plain[LAS_EXTRA_BYTES];
	memcpy(plain, from ? from : nameless, sizeof plain);
	plain[3] = 0;
	if (count > UNKNOWN_BYTES) {
		x->layout->bytes += count;
		return las_note(x->notes, x->error,
						"%zu extra bytes of each point have no type and are left out", count);
	}
	for (size_t i = 0; i < count; i++)
		GW_TRY(add_value(x, plain, LAS_UINT8, i, count));
	return GW_OK;
}

gw_status las_layout_add_extra(las_layout *layout, const las_header *header, scan *notes,
							   gw_error *error)
{
	const extras x = { layout, header, notes, error };
	layout->bytes = las_format_bytes(header->format);
	size_t described = header->extra.length / LAS_EXTRA_BYTES;
	for (size_t d = 0; d < described; d++) {
		const uint8_t *from = header->extra.data + d * LAS_EXTRA_BYTES;
		unsigned type = from[2];
		size_t values = type ? (type - 1) / 10 + 1 : from[3];
		las_kind kind = type ? (las_kind)((type - 1) % 10 + 1) : LAS_UINT8;
		size_t left = header->record - layout->bytes;
		if (type > 30 || values * las_kind_size(kind) > left) {
			GW_TRY(las_note(notes, error,
							"the description of extra value %zu does not fit the %zu bytes that "
							"are left of each point",
							d + 1, left));
			break;
		}
		if (type == 0)
			GW_TRY(add_bytes(&x, from, values));
		for (size_t v = 0; type && v < values; v++)
			GW_TRY(add_value(&x, from, kind, v, values));
	}
	size_t rest = header->record - layout->bytes;
	return rest > 0 ? add_bytes(&x, NULL, rest) : GW_OK;
}
