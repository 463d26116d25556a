/*
 * The body of a PLY file: skips what comes before the vertices, then reads them column by column.
 * Every count is checked against the bytes that are left before anything is allocated.
 */
#include "ply/ply_format.h"
#include "points/column_names.h"
#include "points/scan_color.h"
#include "points/scan_shift.h"
#include "files/number_text.h"
#include "glowworm_host.h"
#include "ply/ply_header.h"
#include "ply/ply_splats.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
	const input_file *in;
	const ply_header *header;
	const ply_element *vertex;
	bool splats; /* that is what the vertices are */
	scan *scan;
	gw_error *error;
	const uint8_t *at, *end; /* what is left of the body */
	size_t line;             /* ascii: number of the line before `at` */
	bool swap;               /* the file's byte order is not ours */
	void **data;             /* one a property: values of its column, NULL for a list
								and for what is of no use */
} reader;

static size_t left(const reader *r)
{
	return (size_t)(r->end - r->at);
}

static size_t offset(const reader *r)
{
	return (size_t)(r->at - r->in->data);
}

/* ------------------------------------------------------------------------------- columns */

static bool has_property(const ply_element *element, const char *name)
{
	for (size_t i = 0; i < element->property_count; i++)
		if (!element->property[i].list && strcmp(element->property[i].name, name) == 0)
			return true;
	return false;
}

/* Name of the column for a property: the canonical one unless another property has it. */
static const char *column_name(const reader *r, const ply_property *property)
{
	const char *name = column_canonical_name(property->name);
	if (strcmp(name, property->name) == 0 || has_property(r->vertex, name) ||
		scan_find(r->scan, name))
		return property->name;
	return name;
}

static gw_status check_position(const reader *r)
{
	static const char *const names[3] = { "x", "y", "z" };
	for (int k = 0; k < 3; k++) {
		bool found = false;
		for (size_t i = 0; i < r->vertex->property_count; i++) {
			const ply_property *property = &r->vertex->property[i];
			found = found || (!property->list &&
							  strcmp(column_canonical_name(property->name), names[k]) == 0);
		}
		if (!found)
			return gw_fail(r->error, GW_ERROR_DATA,
						   "%s: the vertices have no property '%s'; points need x, y and z",
						   r->in->name, names[k]);
	}
	return GW_OK;
}

static gw_status add_columns(reader *r, uint64_t points)
{
	size_t count = r->vertex->property_count;
	r->scan->count = (size_t)points;
	r->data = calloc(count, sizeof *r->data);
	if (!r->data)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the columns of %s", r->in->name);
	for (size_t i = 0; i < count; i++) {
		const ply_property *property = &r->vertex->property[i];
		if (property->list || (r->splats && ply_is_splat_shine(property->name)))
			continue;
		scan_column *column =
			scan_add_column(r->scan, column_name(r, property), property->type, r->error);
		if (!column)
			return GW_ERROR_MEMORY;
		r->data[i] = column->data;
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------- binary bodies */

/* Bytes of an element: all of them without lists, the least possible with lists. */
static size_t least_bytes(const ply_element *element, bool *lists)
{
	size_t bytes = 0;
	*lists = false;
	for (size_t i = 0; i < element->property_count; i++) {
		const ply_property *property = &element->property[i];
		bytes += scan_type_size(property->list ? property->count_type : property->type);
		*lists = *lists || property->list;
	}
	return bytes;
}

static gw_status fail_short(const reader *r, const ply_element *element, size_t bytes)
{
	return gw_fail(r->error, GW_ERROR_DATA,
				   "%s ends at byte %zu, but the header counts %llu of '%.40s' with at least %zu "
				   "bytes each from byte %zu on; the file is cut short or damaged",
				   r->in->name, r->in->length, (unsigned long long)element->count, element->name,
				   bytes, offset(r));
}

static gw_status check_bytes(const reader *r, const ply_element *element, size_t bytes)
{
	if (bytes > 0 && element->count > left(r) / bytes)
		return fail_short(r, element, bytes);
	return GW_OK;
}

/* Copies one value and turns it into our byte order. */
static void take_value(void *to, const uint8_t *from, size_t size, bool swap)
{
	uint16_t two;
	uint32_t four;
	uint64_t eight;
	switch (size) {
	case 1:
		memcpy(to, from, 1);
		break;
	case 2:
		memcpy(&two, from, 2);
		two = swap ? __builtin_bswap16(two) : two;
		memcpy(to, &two, 2);
		break;
	case 4:
		memcpy(&four, from, 4);
		four = swap ? __builtin_bswap32(four) : four;
		memcpy(to, &four, 4);
		break;
	default:
		memcpy(&eight, from, 8);
		eight = swap ? __builtin_bswap64(eight) : eight;
		memcpy(to, &eight, 8);
		break;
	}
}

/* Steps over one list. */
static gw_status skip_list(reader *r, const ply_property *property)
{
	size_t size = scan_type_size(property->count_type);
	uint64_t raw = 0;
	if (size <= left(r)) {
		scan_column one = { .type = property->count_type, .data = &raw };
		take_value(&raw, r->at, size, r->swap);
		double count = scan_value(&one, 0);
		size_t each = scan_type_size(property->type);
		if (count >= 0.0 && (uint64_t)count <= (left(r) - size) / each) {
			r->at += size + (size_t)count * each;
			return GW_OK;
		}
	}
	return gw_fail(r->error, GW_ERROR_DATA,
				   "%s, byte %zu: the list '%.40s' starts here and does not fit into the %zu bytes "
				   "that are left; the file is cut short or damaged",
				   r->in->name, offset(r), property->name, left(r));
}

/* Steps over one element of known size or with lists, or takes it as vertex i. */
static gw_status take_binary(reader *r, const ply_element *element, size_t i)
{
	for (size_t k = 0; k < element->property_count; k++) {
		const ply_property *property = &element->property[k];
		size_t size = scan_type_size(property->type);
		if (property->list) {
			GW_TRY(skip_list(r, property));
			continue;
		}
		if (size > left(r))
			return fail_short(r, element, size);
		if (element == r->vertex && r->data && r->data[k])
			take_value((char *)r->data[k] + i * size, r->at, size, r->swap);
		r->at += size;
	}
	return GW_OK;
}

static gw_status skip_binary(reader *r, const ply_element *element)
{
	bool lists;
	size_t bytes = least_bytes(element, &lists);
	GW_TRY(check_bytes(r, element, bytes));
	if (!lists)
		r->at += bytes * (size_t)element->count;
	for (uint64_t i = 0; i < element->count && lists; i++)
		GW_TRY(take_binary(r, element, 0));
	return GW_OK;
}

/* Vertices of one size: column by column within blocks that stay in the cache. */
#define BLOCK_ROWS ((size_t)1 << 12)

typedef struct rows {
	const reader *r;
	size_t stride;
} rows;

static void take_rows(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	const reader *r = ((const rows *)user)->r;
	size_t stride = ((const rows *)user)->stride;
	const uint8_t *begin = r->at + first * stride, *from = begin;
	for (size_t k = 0; k < r->vertex->property_count; k++) {
		size_t size = scan_type_size(r->vertex->property[k].type);
		char *to = r->data[k] ? (char *)r->data[k] + first * size : NULL;
		for (size_t i = 0; to && i < last - first; i++)
			take_value(to + i * size, from + i * stride, size, r->swap);
		from += size;
	}
	input_file_discard(r->in, begin, begin + (last - first) * stride);
}

static gw_status read_binary(reader *r)
{
	bool lists;
	size_t bytes = least_bytes(r->vertex, &lists);
	GW_TRY(check_bytes(r, r->vertex, bytes));
	GW_TRY(add_columns(r, r->vertex->count));
	if (!lists) {
		gw_parallel_for(r->in->threads, r->scan->count, BLOCK_ROWS, take_rows, &(rows){ r, bytes });
		r->at += r->scan->count * bytes;
	}
	for (size_t i = 0; i < r->scan->count && lists; i++)
		GW_TRY(take_binary(r, r->vertex, i));
	if (r->header->vertex + 1 == r->header->element_count && left(r) >= bytes)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s: %zu bytes follow the last of %zu vertices at byte %zu; the count in "
					   "the header is wrong or the file is damaged",
					   r->in->name, left(r), r->scan->count, offset(r));
	return GW_OK;
}

/* -------------------------------------------------------------------------- ascii bodies */

/* One line, as what is left of it. */
typedef struct ascii_line {
	const char *at, *end;
} ascii_line;

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static void skip_blanks(ascii_line *line)
{
	while (line->at < line->end && is_blank(*line->at))
		line->at++;
}

/* Where the line at r->at ends. Most are short; looking far ahead for the wrong end of a line would
 * take its time at each line again. */
static const uint8_t *line_end(const reader *r)
{
	const size_t most = 1024;
	size_t length = left(r) < most ? left(r) : most;
	const uint8_t *stop = memchr(r->at, '\n', length);
	if (stop && !memchr(r->at, '\r', (size_t)(stop - r->at)))
		return stop;
	for (stop = r->at; stop < r->end && *stop != '\n' && *stop != '\r';)
		stop++;
	return stop;
}

/* The next line that is not blank; false at the end. */
static bool next_line(reader *r, ascii_line *line)
{
	while (r->at < r->end) {
		const uint8_t *start = r->at;
		r->at = line_end(r);
		*line = (ascii_line){ (const char *)start, (const char *)r->at };
		bool pair = left(r) >= 2 && r->at[0] == '\r' && r->at[1] == '\n';
		r->at += r->at == r->end ? 0 : pair ? 2 : 1;
		r->line++;
		skip_blanks(line);
		if (line->at < line->end)
			return true;
	}
	return false;
}

static gw_status fail_value(const reader *r, const ply_property *property, const ascii_line *line,
							const char *expected)
{
	char text[32];
	size_t length = 0;
	for (const char *c = line->at; c < line->end && !is_blank(*c) && length < 30; c++)
		text[length++] = *c >= ' ' && *c <= '~' ? *c : '?';
	text[length] = '\0';
	return gw_fail(r->error, GW_ERROR_DATA, "%s, line %zu: '%s' as '%.40s', where %s was expected",
				   r->in->name, r->line, text, property->name, expected);
}

/* Takes the next word of a line as a number. None reaches over the end of a line, so that it may be
 * looked for up to the end of the file, which is quicker. */
static gw_status take_number(reader *r, const ply_property *property, ascii_line *line,
							 double *value, float *single)
{
	skip_blanks(line);
	size_t length = (size_t)((const char *)r->end - line->at);
	if (line->at == line->end)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s, line %zu ends where a value of '%.40s' was expected", r->in->name,
					   r->line, property->name);
	size_t used =
		single ? number_read_float(line->at, length, single) : number_read(line->at, length, value);
	if (used == 0 || (line->at + used < line->end && !is_blank(line->at[used])))
		return fail_value(r, property, line, "a number");
	line->at += used;
	return GW_OK;
}

/* Smallest and largest value of the integer types. */
static const double limits[SCAN_TYPE_COUNT][2] = {
	[SCAN_INT8] = { INT8_MIN, INT8_MAX },    [SCAN_UINT8] = { 0, UINT8_MAX },
	[SCAN_INT16] = { INT16_MIN, INT16_MAX }, [SCAN_UINT16] = { 0, UINT16_MAX },
	[SCAN_INT32] = { INT32_MIN, INT32_MAX }, [SCAN_UINT32] = { 0, UINT32_MAX },
};

static void store_integer(void *data, scan_type type, size_t i, double value)
{
	/* Two's complement: the low bits of the same number, signed or not. */
	uint32_t bits = (uint32_t)(int64_t)value;
	size_t size = scan_type_size(type);
	if (size == 1)
		((uint8_t *)data)[i] = (uint8_t)bits;
	else if (size == 2)
		((uint16_t *)data)[i] = (uint16_t)bits;
	else
		((uint32_t *)data)[i] = bits;
}

static gw_status take_integer(reader *r, const ply_property *property, scan_type type,
							  ascii_line *line, double *value)
{
	ascii_line before = *line;
	GW_TRY(take_number(r, property, line, value, NULL));
	skip_blanks(&before);
	bool fits = *value >= limits[type][0] && *value <= limits[type][1] && *value == trunc(*value);
	if (!fits) {
		char expected[80];
		snprintf(expected, sizeof expected, "a whole number that fits into %s",
				 ply_type_name(type));
		return fail_value(r, property, &before, expected);
	}
	return GW_OK;
}

static gw_status skip_ascii_list(reader *r, const ply_property *property, ascii_line *line)
{
	double count, ignored;
	GW_TRY(take_integer(r, property, property->count_type, line, &count));
	if (count < 0.0)
		return gw_fail(r->error, GW_ERROR_DATA, "%s, line %zu: the list '%.40s' has a length of %g",
					   r->in->name, r->line, property->name, count);
	for (double i = 0.0; i < count; i += 1.0)
		GW_TRY(take_number(r, property, line, &ignored, NULL));
	return GW_OK;
}

static gw_status take_ascii_value(reader *r, size_t k, size_t i, ascii_line *line)
{
	const ply_property *property = &r->vertex->property[k];
	double value;
	if (property->list)
		return skip_ascii_list(r, property, line);
	if (!r->data[k])
		return take_number(r, property, line, &value, NULL);
	if (property->type == SCAN_FLOAT32)
		return take_number(r, property, line, NULL, (float *)r->data[k] + i);
	if (property->type == SCAN_FLOAT64)
		return take_number(r, property, line, (double *)r->data[k] + i, NULL);
	GW_TRY(take_integer(r, property, property->type, line, &value));
	store_integer(r->data[k], property->type, i, value);
	return GW_OK;
}

static gw_status take_ascii_vertex(reader *r, size_t i)
{
	ascii_line line;
	if (!next_line(r, &line))
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s ends after %zu of the %zu vertices that the header counts; the file is "
					   "cut short or damaged",
					   r->in->name, i, r->scan->count);
	for (size_t k = 0; k < r->vertex->property_count; k++) {
		GW_TRY(take_ascii_value(r, k, i, &line));
	}
	skip_blanks(&line);
	if (line.at < line.end)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s, line %zu has more values than the %zu properties of a vertex",
					   r->in->name, r->line, r->vertex->property_count);
	return GW_OK;
}

static gw_status skip_ascii(reader *r, const ply_element *element)
{
	ascii_line line;
	if (element->property_count == 0)
		return GW_OK;
	for (uint64_t i = 0; i < element->count; i++)
		if (!next_line(r, &line))
			return gw_fail(r->error, GW_ERROR_DATA,
						   "%s ends after %llu of the %llu lines of '%.40s' that the header "
						   "counts; the file is cut short or damaged",
						   r->in->name, (unsigned long long)i, (unsigned long long)element->count,
						   element->name);
	return GW_OK;
}

/* Vertices that a thread reads in one go. */
#define BLOCK_LINES ((size_t)1 << 14)

/* Where the lines of a block begin. */
typedef struct place {
	const uint8_t *at;
	size_t line;
} place;

typedef struct ascii_blocks {
	const reader *r;
	const place *place;
	size_t count;      /* lines in all */
	atomic_size_t bad; /* the first block with a fault */
} ascii_blocks;

static gw_status read_block(const ascii_blocks *b, size_t block, gw_error *error)
{
	reader own = *b->r;
	size_t first = block * BLOCK_LINES, last = first + BLOCK_LINES;
	own.at = b->place[block].at;
	own.line = b->place[block].line;
	own.error = error;
	for (size_t i = first; i < last && i < b->count; i++)
		GW_TRY(take_ascii_vertex(&own, i));
	return GW_OK;
}

static void read_blocks(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	ascii_blocks *b = user;
	for (size_t k = first; k < last && k < atomic_load(&b->bad); k++) {
		size_t before = atomic_load(&b->bad);
		gw_status status = read_block(b, k, NULL);
		input_file_release(b->r->in, b->place[k].at, b->place[k + 1].at);
		if (status != GW_OK)
			while (k < before && !atomic_compare_exchange_weak(&b->bad, &before, k))
				;
	}
}

/* Finds the lines, then reads them on all threads; a block with a fault is read again to say it. */
static gw_status read_vertices(reader *r)
{
	size_t count = r->scan->count;
	place *places = reallocarray(NULL, count / BLOCK_LINES + 2, sizeof *places);
	if (!places)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory to read %s", r->in->name);
	ascii_blocks b = { .r = r, .place = places, .bad = SIZE_MAX };
	reader ahead = *r;
	ascii_line line;
	bool more = true;
	while (b.count < count && more) {
		if (b.count % BLOCK_LINES == 0) {
			size_t block = b.count / BLOCK_LINES;
			places[block] = (place){ ahead.at, ahead.line };
			if (block > 0)
				input_file_release(r->in, places[block - 1].at, ahead.at);
		}
		more = next_line(&ahead, &line);
		b.count += more;
	}
	size_t blocks = (b.count + BLOCK_LINES - 1) / BLOCK_LINES;
	places[blocks] = (place){ ahead.at, ahead.line };
	gw_parallel_for(r->in->threads, blocks, 1, read_blocks, &b);
	gw_status status = GW_OK;
	if (atomic_load(&b.bad) != SIZE_MAX)
		status = read_block(&b, atomic_load(&b.bad), r->error);
	free(places);
	r->at = ahead.at;
	r->line = ahead.line;
	return status == GW_OK && !more ? take_ascii_vertex(r, b.count) : status;
}

static gw_status read_ascii(reader *r)
{
	/* A value takes a digit and what parts it from the next; only the last end may be missing. */
	size_t bytes = 2 * r->vertex->property_count;
	if (r->vertex->count > (left(r) + 1) / bytes)
		return fail_short(r, r->vertex, bytes);
	GW_TRY(add_columns(r, r->vertex->count));
	GW_TRY(read_vertices(r));
	ascii_line line;
	if (r->header->vertex + 1 == r->header->element_count && next_line(r, &line))
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s, line %zu follows the last of %zu vertices; the count in the header is "
					   "wrong or the file is damaged",
					   r->in->name, r->line, r->scan->count);
	return GW_OK;
}

/* ------------------------------------------------------------------------------ the whole */

static bool needs_swap(const ply_header *header)
{
	bool big_host = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
	return big_host != (header->encoding == PLY_BIG_ENDIAN);
}

static gw_status read_body(reader *r)
{
	bool ascii = r->header->encoding == PLY_ASCII;
	r->swap = needs_swap(r->header);
	gw_status status = check_position(r);
	for (size_t e = 0; e < r->header->vertex && status == GW_OK; e++) {
		const ply_element *element = &r->header->element[e];
		status = ascii ? skip_ascii(r, element) : skip_binary(r, element);
	}
	if (status == GW_OK)
		status = ascii ? read_ascii(r) : read_binary(r);
	free(r->data);
	return status;
}

/* Vertices alone are a cloud of a kind, but not an even one. */
static gw_status note_faces(const ply_header *header, scan *cloud, gw_error *error)
{
	for (size_t e = 0; e < header->element_count; e++)
		if (strcmp(header->element[e].name, "face") == 0 && header->element[e].count > 0)
			return scan_add_comment(cloud, MESH_VERTICES_NOTE, error);
	return GW_OK;
}

/* At the beginning of the body. */
static reader reader_of(const input_file *in, const ply_header *header, scan *cloud,
						gw_error *error)
{
	return (reader){ .in = in,
					 .header = header,
					 .vertex = &header->element[header->vertex],
					 .scan = cloud,
					 .error = error,
					 .at = in->data + header->body,
					 .end = in->data + in->length,
					 .line = header->lines };
}

gw_status ply_read(input_file *in, scan *cloud, gw_error *error)
{
	*cloud = (scan){ .up = 'z' };
	ply_header header;
	gw_status status = ply_header_parse(&header, in, cloud, error);
	if (status == GW_OK) {
		reader r = reader_of(in, &header, cloud, error);
		r.splats = ply_is_splats(r.vertex);
		status = read_body(&r);
		if (status == GW_OK && r.splats)
			status = ply_splats_take(cloud, error);
		if (status == GW_OK)
			status = scan_shift_undo(cloud, error);
		if (status == GW_OK)
			status = note_faces(&header, cloud, error);
		ply_header_clear(&header);
	}
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

/* ------------------------------------------------------------------------------ in parts */

static bool may_have_packed_colors(const ply_element *vertex)
{
	bool may = false;
	for (size_t i = 0; i < vertex->property_count; i++)
		may = may || scan_color_may_be_packed(vertex->property[i].name);
	return may;
}

/* Vertices of one size that come first, all of them and no more. */
static bool has_rows(const ply_header *header, const input_file *in, size_t *bytes)
{
	bool lists;
	const ply_element *vertex = &header->element[header->vertex];
	*bytes = least_bytes(vertex, &lists);
	if (header->encoding == PLY_ASCII || header->vertex != 0 || lists || *bytes == 0 ||
		ply_is_splats(vertex) || may_have_packed_colors(vertex))
		return false;
	uint64_t room = (in->length - header->body) / *bytes;
	return vertex->count == room || (vertex->count < room && header->element_count > 1);
}

uint64_t ply_count_rows(input_file *in, uint64_t *together)
{
	scan comments = { 0 };
	ply_header header;
	gw_error ignored = { 0 };
	size_t bytes;
	uint64_t count = 0;
	*together = 1;
	if (ply_header_parse(&header, in, &comments, &ignored) == GW_OK) {
		if (has_rows(&header, in, &bytes))
			count = header.element[header.vertex].count;
		ply_header_clear(&header);
	}
	scan_clear(&comments);
	return count;
}

static gw_status take_part(reader *r, const format_rows *part, size_t bytes)
{
	GW_TRY(check_position(r));
	GW_TRY(add_columns(r, part->count));
	r->swap = needs_swap(r->header);
	r->at += part->first * bytes;
	gw_parallel_for(r->in->threads, r->scan->count, BLOCK_ROWS, take_rows, &(rows){ r, bytes });
	GW_TRY(scan_shift_undo(r->scan, r->error));
	return note_faces(r->header, r->scan, r->error);
}

gw_status ply_read_rows(input_file *in, const format_rows *part, scan *cloud, gw_error *error)
{
	size_t bytes;
	*cloud = (scan){ .up = 'z' };
	ply_header header;
	gw_status status = ply_header_parse(&header, in, cloud, error);
	if (status != GW_OK)
		return status;
	reader r = reader_of(in, &header, cloud, error);
	if (!has_rows(&header, in, &bytes) || part->first > r.vertex->count ||
		part->count > r.vertex->count - part->first)
		status = gw_fail(error, GW_ERROR_DATA, "%s has no points %llu to %llu to be read by parts",
						 in->name, (unsigned long long)part->first,
						 (unsigned long long)(part->first + part->count));
	if (status == GW_OK)
		status = take_part(&r, part, bytes);
	free(r.data);
	ply_header_clear(&header);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}
