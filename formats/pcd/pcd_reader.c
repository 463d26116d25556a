/*
 * The body of a PCD file, into columns. Every count is checked against the bytes that are left
 * before anything is allocated.
 */
#include "points/column_names.h"
#include "points/scan_origin.h"
#include "glowworm_host.h"
#include "pcd/pcd_format.h"
#include "pcd/pcd_header.h"
#include "text/text_rows.h"

#include <liblzf/lzf.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Points that a thread takes in one go. */
#define BLOCK_POINTS ((size_t)4096)

/* One value of a point. */
typedef struct item {
	size_t size;    /* bytes in a binary body */
	bool wide;      /* a 64-bit integer, which becomes a double */
	bool is_signed; /* of a wide one */
	scan_type type; /* of its column */
	void *data;     /* of its column; NULL for padding */
	const char *name;
} item;

typedef struct reader {
	const input_file *in;
	const pcd_header *header;
	const uint8_t *body, *end;
	scan *cloud;
	gw_error *error;
	item *item; /* owned; header->values */
} reader;

/* ------------------------------------------------------------------------------- columns */

static bool is_packed(const pcd_field *field)
{
	return field->size == 4 && field->count == 1 &&
		   (strcasecmp(field->name, "rgb") == 0 || strcasecmp(field->name, "rgba") == 0);
}

static scan_type type_of(const pcd_field *field)
{
	if (field->type == 'F' || field->size == 8)
		return field->size == 8 ? SCAN_FLOAT64 : SCAN_FLOAT32;
	bool is_signed = field->type == 'I';
	return field->size == 1   ? (is_signed ? SCAN_INT8 : SCAN_UINT8)
		   : field->size == 2 ? (is_signed ? SCAN_INT16 : SCAN_UINT16)
							  : (is_signed ? SCAN_INT32 : SCAN_UINT32);
}

/* Text may have more digits of a coordinate than the type that the header gives it. */
static scan_type column_type(const reader *r, const pcd_field *field)
{
	const char *name = column_canonical_name(field->name);
	bool position = name[0] >= 'x' && name[0] <= 'z' && !name[1];
	return position && r->header->encoding == PCD_ASCII ? SCAN_FLOAT64 : type_of(field);
}

/* Name of the column for value `index` of a field: the canonical one unless it is taken. */
static char *column_name(const reader *r, const pcd_field *field, size_t index)
{
	const char *known = column_canonical_name(field->name);
	size_t size = strlen(field->name) + 24;
	char *name = field->count > 1 ? malloc(size) : NULL;
	if (name)
		snprintf(name, size, "%s_%zu", field->name, index);
	if (field->count > 1)
		return name;
	return strdup(scan_find(r->cloud, known) ? field->name : known);
}

static gw_status add_column(reader *r, const pcd_field *field, size_t index, item *to)
{
	char *name = column_name(r, field, index);
	if (!name)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the columns of %s", r->in->name);
	gw_status status = GW_OK;
	scan_column *column = NULL;
	if (scan_find(r->cloud, name))
		status = gw_fail(r->error, GW_ERROR_DATA, "%s: two fields are called '%.40s'", r->in->name,
						 name);
	else if (!(column = scan_add_column(r->cloud, name, to->type, r->error)))
		status = GW_ERROR_MEMORY;
	else
		to->data = column->data;
	free(name);
	return status;
}

static gw_status add_columns(reader *r)
{
	item *to = r->item;
	r->cloud->count = (size_t)r->header->points;
	for (size_t f = 0; f < r->header->field_count; f++) {
		const pcd_field *field = &r->header->field[f];
		for (size_t i = 0; i < field->count; i++, to++) {
			*to = (item){ .size = field->size,
						  .wide = field->size == 8 && field->type != 'F',
						  .is_signed = field->type == 'I',
						  .type = column_type(r, field),
						  .name = field->name };
			if (strcmp(field->name, "_") == 0)
				continue;
			GW_TRY(add_column(r, field, i, to));
		}
	}
	return GW_OK;
}

static gw_status check_position(const reader *r)
{
	static const char *const names[3] = { "x", "y", "z" };
	for (size_t k = 0; k < 3; k++) {
		bool found = false;
		for (size_t f = 0; f < r->header->field_count; f++) {
			const pcd_field *field = &r->header->field[f];
			found = found || (field->count == 1 &&
							  strcmp(column_canonical_name(field->name), names[k]) == 0);
		}
		if (!found)
			return gw_fail(r->error, GW_ERROR_DATA,
						   "%s has no field '%s' of one value; points need x, y and z", r->in->name,
						   names[k]);
	}
	return GW_OK;
}

/* -------------------------------------------------------------------------- binary bodies */

static uint64_t load(const uint8_t *from, size_t size)
{
	uint64_t value = 0;
	for (size_t b = 0; b < size; b++)
		value |= (uint64_t)from[b] << 8 * b;
	return value;
}

/* Values of one item, `step` bytes apart, to points [first, last) of its column. */
static void take_values(const item *to, const uint8_t *from, size_t step, size_t first, size_t last)
{
	for (size_t i = first; i < last; i++, from += step) {
		uint64_t bits = load(from, to->size);
		if (to->size == 1)
			((uint8_t *)to->data)[i] = (uint8_t)bits;
		else if (to->size == 2)
			((uint16_t *)to->data)[i] = (uint16_t)bits;
		else if (to->size == 4)
			((uint32_t *)to->data)[i] = (uint32_t)bits;
		else if (to->wide)
			((double *)to->data)[i] = to->is_signed ? (double)(int64_t)bits : (double)bits;
		else
			memcpy((double *)to->data + i, &bits, sizeof bits);
	}
}

static void take_points(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	const reader *r = user;
	const uint8_t *from = r->body + first * r->header->stride;
	for (size_t i = 0; i < r->header->values; i++) {
		if (r->item[i].data)
			take_values(&r->item[i], from, r->header->stride, first, last);
		from += r->item[i].size;
	}
	input_file_discard(r->in, r->body + first * r->header->stride,
					   r->body + last * r->header->stride);
}

static gw_status read_binary(reader *r)
{
	GW_TRY(add_columns(r));
	gw_parallel_for(r->in->threads, r->cloud->count, BLOCK_POINTS, take_points, r);
	return GW_OK;
}

/* Unpacked, a field's values of all points stand together; those of one point are neighbours. */
static void take_fields(reader *r, const uint8_t *from)
{
	size_t points = r->cloud->count, i = 0;
	for (size_t f = 0; f < r->header->field_count; f++) {
		const pcd_field *field = &r->header->field[f];
		size_t step = field->size * field->count;
		for (size_t k = 0; k < field->count; k++, i++)
			if (r->item[i].data)
				take_values(&r->item[i], from + k * field->size, step, 0, points);
		from += step * points;
	}
}

static gw_status fail_packed(const reader *r, const char *what)
{
	return gw_fail(
		r->error, GW_ERROR_DATA,
		"%s: the compressed points from byte %zu on %s; the file is cut short or damaged",
		r->in->name, r->header->body, what);
}

/* LZF's longest copies make 264 bytes of 3: what a stream claims beyond that is not allocated. */
#define UNPACKED_MOST 88

static gw_status read_compressed(reader *r)
{
	const pcd_header *h = r->header;
	size_t left = (size_t)(r->end - r->body), expected;
	if (left < 8)
		return fail_packed(r, "lack their sizes");
	unsigned packed = (unsigned)load(r->body, 4), claimed = (unsigned)load(r->body + 4, 4);
	if (packed > left - 8)
		return fail_packed(r, "are fewer than their size says");
	if (__builtin_mul_overflow(h->points, h->stride, &expected) || expected != claimed)
		return fail_packed(r, "have a size that differs from the header's");
	if (claimed / UNPACKED_MOST > packed || (packed == 0) != (claimed == 0))
		return fail_packed(r, "do not unpack to their size");
	uint8_t *bytes = malloc(claimed ? claimed : 1);
	if (!bytes)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory to unpack the %u bytes of %s", claimed,
					   r->in->name);
	if (claimed > 0 && lzf_decompress(r->body + 8, packed, bytes, claimed) != claimed) {
		free(bytes);
		return fail_packed(r, "do not unpack to their size");
	}
	gw_status status = add_columns(r);
	if (status == GW_OK)
		take_fields(r, bytes);
	free(bytes);
	return status;
}

/* --------------------------------------------------------------------------- ascii bodies */

static gw_status read_rows(reader *r, text_rows *rows)
{
	if (rows->count != r->header->points)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s: %zu rows follow the header, which counts %llu points; the file is cut "
					   "short or its header is wrong",
					   r->in->name, rows->count, (unsigned long long)r->header->points);
	GW_TRY(add_columns(r));
	text_column *column = calloc(rows->width, sizeof *column);
	if (!column)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the columns of %s", r->in->name);
	for (size_t i = 0; i < rows->width; i++)
		column[i] = (text_column){ .name = r->item[i].name,
								   .type = r->item[i].type,
								   .data = r->item[i].data };
	gw_status status = text_rows_read(rows, column, r->error);
	free(column);
	return status;
}

static gw_status read_ascii(reader *r)
{
	const char *line;
	size_t length;
	text_rows rows = { .in = r->in,
					   .begin = (const char *)r->body,
					   .end = (const char *)r->end,
					   .first_line = r->header->lines + 1,
					   .newline = '\n',
					   .separator = ' ',
					   .width = r->header->values };
	if (text_rows_first(&rows, &line, &length))
		rows.separator = text_rows_separator(line, length);
	gw_status status = text_rows_count(&rows, r->error);
	if (status == GW_OK)
		status = read_rows(r, &rows);
	text_rows_clear(&rows);
	return status;
}

/* ------------------------------------------------------------------------------ the whole */

/* Moves the last columns to stand before the one at `place`. */
static void move_last(scan *cloud, size_t count, size_t place)
{
	scan_column moved[4];
	size_t first = cloud->column_count - count;
	memcpy(moved, cloud->column + first, count * sizeof *moved);
	memmove(cloud->column + place + count, cloud->column + place, (first - place) * sizeof *moved);
	memcpy(cloud->column + place, moved, count * sizeof *moved);
}

/* Takes red, green, blue and alpha out of 32 bits. Some programs store them as a float; one that is
 * not a number is what they write for points without a colour. */
static gw_status unpack_colors(reader *r, const pcd_field *field)
{
	static const char *const names[4] = { "red", "green", "blue", "alpha" };
	static const unsigned shift[4] = { 16, 8, 0, 24 };
	size_t channels = strlen(field->name), count = r->cloud->count;
	for (size_t k = 0; k < channels; k++)
		if (scan_find(r->cloud, names[k]))
			return GW_OK; /* they are there already, so this is a column like others */
	for (size_t k = 0; k < channels; k++) {
		scan_column *to = scan_add_column(r->cloud, names[k], SCAN_UINT8, r->error);
		if (!to)
			return GW_ERROR_MEMORY;
		const scan_column *packed = scan_find(r->cloud, field->name);
		const uint32_t *bits = packed->data;
		for (size_t i = 0; i < count; i++) {
			bool none = field->type == 'F' && (bits[i] & 0x7fffffff) > 0x7f800000 &&
						r->header->encoding == PCD_ASCII;
			((uint8_t *)to->data)[i] = (uint8_t)(none ? 0u : bits[i] >> shift[k]);
		}
	}
	size_t place = (size_t)(scan_find(r->cloud, field->name) - r->cloud->column);
	scan_remove_column(r->cloud, field->name);
	move_last(r->cloud, channels, place);
	return GW_OK;
}

/* Before anything is allocated: the points counted must fit into the bytes that are there. A value
 * of text takes two, but for the last. Compressed points are measured when they are unpacked. */
static gw_status check_size(const reader *r)
{
	const pcd_header *h = r->header;
	size_t left = (size_t)(r->end - r->body), stride = h->stride;
	bool ascii = h->encoding == PCD_ASCII, wrong = false;
	if (ascii)
		wrong = h->points > (left + 1) / (2 * h->values);
	else if (h->encoding == PCD_BINARY)
		wrong = h->points > left / stride;
	if (wrong)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s has %zu bytes from byte %zu on, but %llu points of %zu %s are counted; "
					   "the file is cut short or its header is wrong",
					   r->in->name, left, h->body, (unsigned long long)h->points,
					   ascii ? h->values : stride, ascii ? "values" : "bytes");
	return GW_OK;
}

static gw_status read_body(reader *r)
{
	gw_status status = check_position(r);
	if (status == GW_OK)
		status = check_size(r);
	GW_TRY(status);
	r->item = calloc(r->header->values, sizeof *r->item);
	if (!r->item)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the columns of %s", r->in->name);
	if (r->header->encoding == PCD_ASCII)
		status = read_ascii(r);
	else if (r->header->encoding == PCD_BINARY)
		status = read_binary(r);
	else
		status = read_compressed(r);
	free(r->item);
	for (size_t f = 0; f < r->header->field_count && status == GW_OK; f++)
		if (is_packed(&r->header->field[f]))
			status = unpack_colors(r, &r->header->field[f]);
	return status;
}

/* Some programs leave bytes behind the points. */
static gw_status note_rest(const reader *r)
{
	const pcd_header *h = r->header;
	size_t left = (size_t)(r->end - r->body);
	char text[160];
	if (h->encoding != PCD_BINARY || left - h->points * h->stride < h->stride)
		return GW_OK;
	snprintf(text, sizeof text,
			 SCAN_NOTE "%zu bytes behind the %llu point%s that its header counts were left out",
			 left - (size_t)h->points * h->stride, (unsigned long long)h->points,
			 gw_plural(h->points, "", "s"));
	return scan_add_comment(r->cloud, text, r->error);
}

static bool moves_nothing(const pcd_header *h)
{
	static const double usual[7] = { 0, 0, 0, 1, 0, 0, 0 };
	for (int k = 0; k < 7; k++)
		if (h->viewpoint[k] != usual[k])
			return false;
	return true;
}

/* Sums for a straight line through points. */
typedef struct line_sums {
	double n, x, y, xx, yy, xy;
} line_sums;

static void add_to_line(line_sums *s, double x, double y)
{
	s->n++;
	s->x += x;
	s->y += y;
	s->xx += x * x;
	s->yy += y * y;
	s->xy += x * y;
}

/* Whether they rise along a line, but for one part in twenty of the variance. */
static bool rises_straight(const line_sums *s)
{
	double xx = s->n * s->xx - s->x * s->x, yy = s->n * s->yy - s->y * s->y;
	double xy = s->n * s->xy - s->x * s->y;
	return xy > 0.0 && xy * xy > 0.95 * xx * yy;
}

#define CAMERA_SAMPLES 20000 /* points that are looked at */
#define CAMERA_LEAST 50      /* fewer say nothing */

/* A depth camera's picture in its own frame: all in front of it along z, columns go with x / z and
 * rows, from the top, with y / z. */
static bool is_camera_frame(const pcd_header *h, const scan *cloud)
{
	const scan_column *column[3] = { scan_find(cloud, "x"), scan_find(cloud, "y"),
									 scan_find(cloud, "z") };
	line_sums columns = { 0 }, rows = { 0 };
	if (h->width < 2 || h->height < 2 || h->viewpoint[0] != 0.0 || h->viewpoint[1] != 0.0 ||
		h->viewpoint[2] != 0.0)
		return false;
	for (size_t i = 0; i < cloud->count; i += cloud->count / CAMERA_SAMPLES + 1) {
		double p[3];
		for (int k = 0; k < 3; k++)
			p[k] = scan_value(column[k], i);
		if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
			continue;
		if (!(p[2] > 0.0))
			return false;
		add_to_line(&columns, (double)(i % h->width), p[0] / p[2]);
		add_to_line(&rows, (double)(i / h->width), p[1] / p[2]);
	}
	return rows.n >= CAMERA_LEAST && rises_straight(&columns) && rises_straight(&rows);
}

static gw_status take_frame(const pcd_header *h, scan *cloud, gw_error *error)
{
	if (!is_camera_frame(h, cloud))
		return GW_OK;
	cloud->up = 'Y';
	return scan_add_comment(cloud,
							SCAN_NOTE "this is a depth camera's picture in its own frame, in which "
									  "-y points up; if it does not, give --up",
							error);
}

/*
 * The default says nothing. In an organised cloud it is the camera itself where the points are in
 * its frame, or where rows and columns are seen from there; else what they are seen from. Where
 * they are seen from nowhere, as those of a laser that nods, nobody knows where it stood.
 */
static gw_status take_viewpoint(const pcd_header *h, scan *cloud, gw_error *error)
{
	const double *place = h->viewpoint;
	if (moves_nothing(h)) {
		if (h->height < 2 || h->width < 2)
			return GW_OK;
		if (cloud->image_count > 0 && scan_settle_origin(cloud, 0))
			place = cloud->image[0].scanner;
		else if (!is_camera_frame(h, cloud))
			return scan_add_comment(cloud,
									SCAN_NOTE "the file's VIEWPOINT is the default, and rows and "
											  "columns were not seen from there, nor from any one "
											  "place, so that they do not tell where the scanner "
											  "stood; --scanner says it",
									error);
	}
	return scan_add_scanner(cloud, place, 0, cloud->count, error);
}

/* An organised cloud is a picture, row after row. */
static gw_status take_image(const pcd_header *h, scan *cloud, gw_error *error)
{
	if (h->height < 2 || h->width < 2 || h->height > cloud->count / h->width ||
		h->height * h->width != cloud->count || cloud->count >= UINT32_MAX)
		return GW_OK;
	gw_range_image image = { .count = cloud->count,
							 .columns = (uint32_t)h->width,
							 .rows = (uint32_t)h->height };
	memcpy(image.scanner, h->viewpoint, sizeof image.scanner);
	GW_TRY(scan_add_image(cloud, &image, error));
	for (size_t i = 0; i < cloud->count; i++)
		cloud->image_cell[i] = (uint32_t)i;
	return GW_OK;
}

static gw_status read_all(reader *r)
{
	GW_TRY(read_body(r));
	GW_TRY(note_rest(r));
	GW_TRY(take_frame(r->header, r->cloud, r->error));
	GW_TRY(take_image(r->header, r->cloud, r->error));
	return take_viewpoint(r->header, r->cloud, r->error);
}

static reader reader_of(const input_file *in, const pcd_header *header, scan *cloud,
						gw_error *error)
{
	return (reader){ .in = in,
					 .header = header,
					 .body = in->data + header->body,
					 .end = in->data + in->length,
					 .cloud = cloud,
					 .error = error };
}

gw_status pcd_read(input_file *in, scan *cloud, gw_error *error)
{
	pcd_header header;
	*cloud = (scan){ .up = 'z' };
	gw_status status = pcd_header_parse(&header, in, cloud, error);
	if (status == GW_OK) {
		reader r = reader_of(in, &header, cloud, error);
		status = read_all(&r);
		pcd_header_clear(&header);
	}
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

/* Whether points can be read from anywhere: in a picture, all of them tell where its camera was. */
static bool has_parts(const input_file *in, const pcd_header *h)
{
	bool picture = h->height > 1 && h->width > 1;
	return h->encoding == PCD_BINARY && !picture && h->stride > 0 &&
		   h->points <= (in->length - h->body) / h->stride;
}

static uint64_t pcd_count_rows(input_file *in, uint64_t *together)
{
	pcd_header header;
	scan comments = { .up = 'z' };
	uint64_t count = 0;
	*together = 1;
	if (pcd_header_parse(&header, in, &comments, NULL) == GW_OK) {
		count = has_parts(in, &header) ? header.points : 0;
		pcd_header_clear(&header);
	}
	scan_clear(&comments);
	return count;
}

/* Some points as if the file had no others, but for what is said of all. */
static gw_status read_part(reader *r, pcd_header *header, const format_rows *rows)
{
	uint64_t left = rows->first < header->points ? header->points - rows->first : 0;
	GW_TRY(note_rest(r));
	r->body += (left > 0 ? rows->first : 0) * header->stride;
	header->points = rows->count < left ? rows->count : left;
	GW_TRY(read_body(r));
	return take_viewpoint(header, r->cloud, r->error);
}

static gw_status pcd_read_rows(input_file *in, const format_rows *rows, scan *cloud,
							   gw_error *error)
{
	pcd_header header;
	*cloud = (scan){ .up = 'z' };
	gw_status status = pcd_header_parse(&header, in, cloud, error);
	if (status == GW_OK) {
		reader r = reader_of(in, &header, cloud, error);
		status = read_part(&r, &header, rows);
		pcd_header_clear(&header);
	}
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

static bool probe(const uint8_t *head, size_t length)
{
	static const char *const starts[] = { "# .PCD", "VERSION ", "FIELDS ", "COLUMNS " };
	for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
		size_t size = strlen(starts[i]);
		if (length >= size && memcmp(head, starts[i], size) == 0)
			return true;
	}
	return false;
}

static const char *const extensions[] = { "pcd", NULL };

const format pcd_format = {
	.name = "pcd",
	.description = "point cloud data of PCL",
	.extensions = extensions,
	.probe = probe,
	.read = pcd_read,
	.count_rows = pcd_count_rows,
	.read_rows = pcd_read_rows,
	.write = pcd_write,
	.parted = &pcd_parted,
};
