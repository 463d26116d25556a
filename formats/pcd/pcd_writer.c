#include "files/little_endian.h"
#include "files/number_text.h"
#include "pcd/pcd_format.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points that are put together before they are handed on. */
#define BLOCK_POINTS ((size_t)1024)

/* One field of the file: a column, or colours of 8 bits packed into four bytes. */
typedef struct field {
	const scan_column *column;    /* NULL for packed ones */
	bool single;                  /* doubles that are floats, which PCL itself can read */
	const scan_column *packed[4]; /* blue green red alpha, as the bytes stand; alpha may be NULL */
} field;

typedef struct writer {
	output_file *out;
	const char *name; /* of the file, for messages */
	const scan *cloud;
	field *field; /* owned; field_count */
	size_t field_count, stride;
	uint64_t count; /* points of the file */
	bool single;    /* single precision holds all of its coordinates */
} writer;

static size_t field_size(const field *f)
{
	return f->column && !f->single ? scan_type_size(f->column->type) : 4;
}

static char field_type(const field *f)
{
	if (!f->column)
		return f->packed[3] ? 'U' : 'F';
	scan_type type = f->column->type;
	if (type == SCAN_FLOAT32 || type == SCAN_FLOAT64)
		return 'F';
	return type == SCAN_INT8 || type == SCAN_INT16 || type == SCAN_INT32 ? 'I' : 'U';
}

/* Finds colours of 8 bits. */
static bool find_packed(const scan *cloud, field *f)
{
	static const char *const names[4] = { "blue", "green", "red", "alpha" };
	*f = (field){ 0 };
	for (int k = 0; k < 4; k++) {
		const scan_column *column = scan_find(cloud, names[k]);
		if (column && column->type == SCAN_UINT8)
			f->packed[k] = column;
		else if (k < 3)
			return false;
	}
	return true;
}

static bool is_packed(const field *packed, const scan_column *column)
{
	for (int k = 0; k < 4; k++)
		if (packed->packed[k] == column)
			return true;
	return false;
}

/* True when single precision holds every value. */
static bool fits_single(const scan_column *column, size_t count)
{
	const double *value = column->data;
	if (column->type != SCAN_FLOAT64)
		return false;
	for (size_t i = 0; i < count; i++)
		if ((double)(float)value[i] != value[i] && !isnan(value[i]))
			return false;
	return true;
}

/* Coordinates are one type, or programs read none of them. */
static bool has_single_position(const scan *cloud)
{
	static const char *const names[3] = { "x", "y", "z" };
	bool all = true;
	for (int k = 0; k < 3 && all; k++) {
		const scan_column *column = scan_find(cloud, names[k]);
		all = column && fits_single(column, cloud->count);
	}
	return all;
}

static bool is_position(const scan_column *column)
{
	return column->name[0] >= 'x' && column->name[0] <= 'z' && !column->name[1];
}

/* Fields in the columns' order; the packed one stands where its first column does. */
static gw_status list_fields(writer *w, gw_error *error)
{
	field packed;
	bool pack = find_packed(w->cloud, &packed), done = false;
	w->field = calloc(w->cloud->column_count + 1, sizeof *w->field);
	if (!w->field)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", w->name);
	for (size_t c = 0; c < w->cloud->column_count; c++) {
		const scan_column *column = &w->cloud->column[c];
		bool part = pack && is_packed(&packed, column);
		if (part && done)
			continue;
		done = done || part;
		field *f = &w->field[w->field_count++];
		*f =
			part ? packed : (field){ .column = column, .single = w->single && is_position(column) };
		w->stride += field_size(f);
	}
	return GW_OK;
}

/* -------------------------------------------------------------------------------- header */

static gw_status write_name(output_file *out, const field *f, gw_error *error)
{
	if (!f->column)
		return output_file_print(out, error, " %s", f->packed[3] ? "rgba" : "rgb");
	static const char *const normal[3] = { "normal_x", "normal_y", "normal_z" };
	const char *own = f->column->name;
	if (own[0] == 'n' && own[1] >= 'x' && own[1] <= 'z' && !own[2])
		own = normal[own[1] - 'x'];
	char *name = strdup(own[0] ? own : "unnamed");
	if (!name)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	for (char *c = name; *c; c++)
		if ((unsigned char)*c <= ' ')
			*c = '_';
	gw_status status = output_file_print(out, error, " %s", name);
	free(name);
	return status;
}

static gw_status write_comments(output_file *out, const scan *cloud, gw_error *error)
{
	gw_status status = GW_OK;
	for (size_t i = 0; i < cloud->comment_count && status == GW_OK; i++) {
		char *line = strdup(cloud->comment[i]);
		if (!line)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for a comment line");
		for (char *c = line; *c; c++)
			if ((unsigned char)*c < ' ')
				*c = ' ';
		status = output_file_print(out, error, "# %s\n", line);
		free(line);
	}
	return status;
}

bool pcd_is_picture(const scan *cloud)
{
	const gw_range_image *image = cloud->image;
	if (cloud->image_count != 1 || image->first != 0 || image->count != cloud->count ||
		(uint64_t)image->columns * image->rows != cloud->count)
		return false;
	for (size_t i = 0; i < cloud->count; i++)
		if (cloud->image_cell[i] != i)
			return false;
	return true;
}

static gw_status write_viewpoint(output_file *out, const scan *cloud, gw_error *error)
{
	output_file_print(out, NULL, "VIEWPOINT");
	for (int k = 0; k < 3; k++) {
		char text[NUMBER_TEXT];
		number_print(text, cloud->scanner_count == 1 ? cloud->scanner[k] : 0.0);
		output_file_print(out, NULL, " %s", text);
	}
	return output_file_print(out, error, " 1 0 0 0\n");
}

static gw_status write_header(writer *w, gw_error *error)
{
	output_file *out = w->out;
	output_file_print(out, NULL, "# .PCD v0.7 - Point Cloud Data file format\n");
	GW_TRY(write_comments(out, w->cloud, error));
	output_file_print(out, NULL, "VERSION 0.7\nFIELDS");
	for (size_t f = 0; f < w->field_count; f++)
		GW_TRY(write_name(out, &w->field[f], error));
	output_file_print(out, NULL, "\nSIZE");
	for (size_t f = 0; f < w->field_count; f++)
		output_file_print(out, NULL, " %zu", field_size(&w->field[f]));
	output_file_print(out, NULL, "\nTYPE");
	for (size_t f = 0; f < w->field_count; f++)
		output_file_print(out, NULL, " %c", field_type(&w->field[f]));
	output_file_print(out, NULL, "\nCOUNT");
	for (size_t f = 0; f < w->field_count; f++)
		output_file_print(out, NULL, " 1");
	bool picture = pcd_is_picture(w->cloud);
	unsigned long long count = w->count, columns = picture ? w->cloud->image->columns : count;
	output_file_print(out, NULL, "\nWIDTH %llu\nHEIGHT %u\n", columns,
					  picture ? w->cloud->image->rows : 1u);
	GW_TRY(write_viewpoint(out, w->cloud, error));
	output_file_print(out, NULL, "POINTS %llu\n", count);
	return output_file_print(out, error, "DATA binary\n");
}

/* ---------------------------------------------------------------------------------- body */

static void put_field(const writer *w, const field *f, uint8_t *to, size_t first, size_t count)
{
	size_t size = field_size(f);
	for (size_t i = 0; i < count; i++, to += w->stride) {
		if (f->single) {
			float value = (float)((const double *)f->column->data)[first + i];
			store_value(to, (const uint8_t *)&value, sizeof value);
			continue;
		}
		if (f->column) {
			store_value(to, (const uint8_t *)f->column->data + (first + i) * size, size);
			continue;
		}
		for (int k = 0; k < 4; k++)
			to[k] = f->packed[k] ? ((const uint8_t *)f->packed[k]->data)[first + i] : 0;
	}
}

static gw_status write_points(writer *w, gw_error *error)
{
	uint8_t *block = reallocarray(NULL, w->stride ? w->stride : 1, BLOCK_POINTS);
	if (!block)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", w->name);
	gw_status status = GW_OK;
	for (size_t first = 0; first < w->cloud->count && status == GW_OK; first += BLOCK_POINTS) {
		size_t rest = w->cloud->count - first, count = rest < BLOCK_POINTS ? rest : BLOCK_POINTS;
		uint8_t *to = block;
		for (size_t f = 0; f < w->field_count; f++) {
			put_field(w, &w->field[f], to, first, count);
			to += field_size(&w->field[f]);
		}
		status = output_file_write(w->out, block, w->stride * count, error);
	}
	free(block);
	return status;
}

gw_status pcd_write(output_file *out, const scan *cloud, gw_error *error)
{
	writer w = { .out = out,
				 .name = output_file_name(out),
				 .cloud = cloud,
				 .count = cloud->count,
				 .single = has_single_position(cloud) };
	gw_status status = list_fields(&w, error);
	if (status == GW_OK)
		status = write_header(&w, error);
	if (status == GW_OK)
		status = write_points(&w, error);
	free(w.field);
	return status;
}

/* ------------------------------------------------------------------------------ in parts */

/* PCD's own part of format.parted. */
typedef struct format_survey {
	bool wide; /* single precision does not hold all coordinates */
} pcd_survey;

static gw_status survey_begin(format_whole *whole, gw_error *error)
{
	whole->survey = calloc(1, sizeof *whole->survey);
	return whole->survey ? GW_OK
						 : gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", whole->name);
}

static gw_status survey_add(format_whole *whole, const scan *part, gw_error *error)
{
	(void)error;
	whole->survey->wide = whole->survey->wide || !has_single_position(part);
	return GW_OK;
}

/* Its fields are to be freed, also on failure. */
static gw_status begin_part(const format_whole *whole, const scan *part, output_file *out,
							writer *w, gw_error *error)
{
	*w = (writer){ .out = out,
				   .name = whole->name,
				   .cloud = part,
				   .count = whole->count,
				   .single = !whole->survey->wide };
	return list_fields(w, error);
}

static gw_status row(const format_whole *whole, const scan *part, size_t *bytes, gw_error *error)
{
	writer w;
	gw_status status = begin_part(whole, part, NULL, &w, error);
	*bytes = w.stride;
	free(w.field);
	return status;
}

static gw_status write_part(output_file *out, const format_whole *whole, const scan *part,
							gw_status (*write)(writer *w, gw_error *error), gw_error *error)
{
	writer w;
	gw_status status = begin_part(whole, part, out, &w, error);
	if (status == GW_OK)
		status = write(&w, error);
	free(w.field);
	return status;
}

static gw_status write_head(output_file *out, const format_whole *whole, const scan *first,
							gw_error *error)
{
	return write_part(out, whole, first, write_header, error);
}

static gw_status write_rows(output_file *out, const format_whole *whole, const scan *part,
							gw_error *error)
{
	return write_part(out, whole, part, write_points, error);
}

const format_parted pcd_parted = {
	.survey_begin = survey_begin,
	.survey_add = survey_add,
	.row = row,
	.write_head = write_head,
	.write_rows = write_rows,
};
