/* e57_layout.c - see e57_layout.h. */
#include "e57/e57_layout.h"
#include "e57/e57_names.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Most records of a packet, and a step that lets each field end on a byte; most bytes of one. */
#define PACKET_RECORDS ((size_t)8192)
#define PACKET_STEP ((size_t)8)
#define PACKET_BYTES ((size_t)65536)

static const char *const axis_name[3] = { "x", "y", "z" };

typedef struct maker {
	e57_layout *layout;
	const scan *cloud;
	const char *name;
	const e57_known *known; /* NULL: the cloud has all points */
	gw_error *error;
} maker;

static gw_status fail_memory(const maker *m)
{
	return gw_fail(m->error, GW_ERROR_MEMORY, "no memory to lay out the points of %s", m->name);
}

/* ---------------------------------------------------------------------------------- scans */

/* Which scanner saw a point; one more than all where none did. */
static size_t scanner_of(const scan *cloud, size_t i)
{
	uint32_t scanner = cloud->scanner_of[i];
	return scanner < cloud->scanner_count ? scanner : cloud->scanner_count;
}

/* Puts the points of each scanner behind each other. first: of each, and of one more than all */
static gw_status sort_points(maker *m, size_t *first)
{
	const scan *cloud = m->cloud;
	size_t scans = cloud->scanner_count + 1;
	for (size_t i = 0; i < cloud->count; i++)
		first[scanner_of(cloud, i) + 1]++;
	for (size_t s = 0; s < scans; s++)
		first[s + 1] += first[s];
	size_t *next = reallocarray(NULL, scans, sizeof *next);
	m->layout->order = next ? reallocarray(NULL, cloud->count, sizeof *m->layout->order) : NULL;
	if (!m->layout->order) {
		free(next);
		return fail_memory(m);
	}
	memcpy(next, first, scans * sizeof *next);
	for (size_t i = 0; i < cloud->count; i++)
		m->layout->order[next[scanner_of(cloud, i)]++] = i;
	free(next);
	return GW_OK;
}

static gw_status part_scans(maker *m)
{
	const scan *cloud = m->cloud;
	size_t scans = cloud->scanner_count + 1, *first = calloc(scans + 1, sizeof *first);
	gw_status status = first ? sort_points(m, first) : fail_memory(m);
	e57_layout *l = m->layout;
	l->scan = status == GW_OK ? calloc(scans, sizeof *l->scan) : NULL;
	if (status == GW_OK && !l->scan)
		status = fail_memory(m);
	for (size_t s = 0; s < scans && status == GW_OK; s++)
		if (first[s + 1] > first[s])
			l->scan[l->scan_count++] =
				(e57_out_scan){ .first = first[s],
								.count = first[s + 1] - first[s],
								.place = s + 1 < scans ? cloud->scanner + 3 * s : NULL };
	free(first);
	return status;
}

static gw_status make_scans(maker *m)
{
	const scan *cloud = m->cloud;
	e57_layout *l = m->layout;
	if (cloud->count == 0 && !m->known)
		return GW_OK;
	if (!m->known && cloud->scanner_of && cloud->scanner_count <= E57_SCANS_MOST)
		return part_scans(m);
	l->scan = calloc(1, sizeof *l->scan);
	if (!l->scan)
		return fail_memory(m);
	bool alone = cloud->scanner_count == 1 && !cloud->scanner_of;
	l->scan[l->scan_count++] =
		(e57_out_scan){ .count = m->known ? (size_t)m->known->count : cloud->count,
						.place = alone ? cloud->scanner : NULL };
	return GW_OK;
}

/* The image that all points of a scan belong to. */
static const gw_range_image *find_image(const e57_layout *l, const e57_out_scan *s)
{
	const scan *cloud = l->cloud;
	for (size_t k = 0; k < cloud->image_count; k++) {
		const gw_range_image *image = &cloud->image[k];
		size_t first = e57_layout_point(l, s, 0), i = 0;
		if (first < image->first || first - image->first >= image->count)
			continue;
		for (; i < s->count; i++) {
			size_t p = e57_layout_point(l, s, i);
			if (p < image->first || p - image->first >= image->count ||
				cloud->image_cell[p] / image->columns >= image->rows)
				break;
		}
		return i == s->count ? image : NULL;
	}
	return NULL;
}

/* ---------------------------------------------------------------------------------- fields */

double e57_layout_local(double value, double place)
{
	double local = value - place;
	const double other[2] = { nextafter(local, INFINITY), nextafter(local, -INFINITY) };
	for (int k = 0; k < 2 && local + place != value; k++)
		if (other[k] + place == value)
			return other[k];
	return local;
}

static bool all_finite(const e57_layout *l, const e57_out_scan *s)
{
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(l->cloud, axis_name[k]);
		for (size_t i = 0; column && i < s->count; i++)
			if (!isfinite(scan_value(column, e57_layout_point(l, s, i))))
				return false;
	}
	return true;
}

bool e57_layout_is_finite(const e57_out_scan *s, size_t p)
{
	for (size_t f = 0; f < s->field_count; f++)
		if (s->field[f].source == E57_OF_POSITION && !isfinite(scan_value(s->field[f].column, p)))
			return false;
	return true;
}

/* Colours of 8 bits, and those of the surface of a lit cloud, have the limits of their type,
 * whatever values they take, so that these need not be known. */
static bool is_color(const scan_column *column)
{
	bool color = false, albedo = false;
	for (int k = 0; k < 3; k++) {
		color = color || strcmp(column->name, scan_color_names[k]) == 0;
		albedo = albedo || strcmp(column->name, scan_albedo_names[k]) == 0;
	}
	return albedo || (color && column->type == SCAN_UINT8);
}

static void take_type_limits(e57_out_field *f)
{
	static const double limits[SCAN_TYPE_COUNT][2] = {
		[SCAN_INT8] = { INT8_MIN, INT8_MAX },    [SCAN_UINT8] = { 0, UINT8_MAX },
		[SCAN_INT16] = { INT16_MIN, INT16_MAX }, [SCAN_UINT16] = { 0, UINT16_MAX },
		[SCAN_INT32] = { INT32_MIN, INT32_MAX }, [SCAN_UINT32] = { 0, UINT32_MAX },
	};
	f->low = limits[f->column->type][0];
	f->high = limits[f->column->type][1];
}

/* Of a column that only a result has nothing is known. */
static void take_limits(const e57_known *known, e57_out_field *f)
{
	for (size_t c = 0; c < known->column_count; c++) {
		const e57_column_limits *limits = &known->column[c];
		if (strcmp(limits->name, f->column->name) != 0 || limits->type != f->column->type)
			continue;
		f->low = limits->low;
		f->high = limits->high;
		return;
	}
	take_type_limits(f);
}

/* Of a position those of points that have one. */
static void find_limits(const e57_layout *l, const e57_out_scan *s, e57_out_field *f)
{
	bool position = f->source == E57_OF_POSITION;
	for (size_t i = 0; i < s->count; i++) {
		size_t p = e57_layout_point(l, s, i);
		double value = scan_value(f->column, p);
		if (!isfinite(value) || (position && !e57_layout_is_finite(s, p)))
			continue;
		if (position && s->place)
			value = e57_layout_local(value, s->place[f->axis]);
		f->low = fmin(f->low, value);
		f->high = fmax(f->high, value);
	}
}

/* Limits of what a field holds, which integers are written by. */
static void set_limits(const maker *m, const e57_out_scan *s, e57_out_field *f)
{
	f->low = INFINITY;
	f->high = -INFINITY;
	e57_field *field = &f->field;
	bool whole = field->type == E57_INTEGER;
	if (whole && is_color(f->column))
		take_type_limits(f);
	else if (!m->known)
		find_limits(m->layout, s, f);
	else if (whole)
		take_limits(m->known, f);
	if (field->type == E57_INTEGER && f->low <= f->high) {
		field->minimum = (int64_t)f->low;
		field->maximum = (int64_t)f->high;
	}
}

static void find_bits(e57_field *field)
{
	uint64_t range = (uint64_t)field->maximum - (uint64_t)field->minimum;
	field->bits = field->type == E57_SINGLE   ? 32
				  : field->type == E57_DOUBLE ? 64
				  : range                     ? 64u - (unsigned)__builtin_clzll(range)
											  : 0;
}

/* Adds a field whose name it takes. */
static gw_status add_field(maker *m, e57_out_scan *s, const e57_out_field *field)
{
	if (!field->field.name)
		return fail_memory(m);
	s->field[s->field_count++] = *field;
	return GW_OK;
}

static gw_status add_column(maker *m, e57_out_scan *s, const scan_column *column)
{
	bool single = column->type == SCAN_FLOAT32, real = single || column->type == SCAN_FLOAT64;
	e57_out_field f = { .column = column, .source = E57_OF_COLUMN };
	f.field.type = single ? E57_SINGLE : real ? E57_DOUBLE : E57_INTEGER;
	f.field.name = e57_name_write(m->cloud, column);
	for (int k = 0; k < 3; k++)
		if (strcmp(column->name, axis_name[k]) == 0) {
			f.source = E57_OF_POSITION;
			f.axis = k;
			f.field.type = single && !s->place ? E57_SINGLE : E57_DOUBLE;
		}
	return add_field(m, s, &f);
}

/* What no column has: which records have no position, and their cells in the picture of a scanner.
 */
static gw_status add_others(maker *m, e57_out_scan *s)
{
	if (!(m->known ? m->known->finite : all_finite(m->layout, s)))
		GW_TRY(add_field(
			m, s,
			&(e57_out_field){ .field = { .name = strdup("cartesianInvalidState"), .maximum = 2 },
							  .source = E57_OF_STATE }));
	if (!s->image || scan_find(m->cloud, "rowIndex") || scan_find(m->cloud, "columnIndex"))
		return GW_OK;
	const int64_t rows = s->image->rows, columns = s->image->columns;
	GW_TRY(add_field(m, s,
					 &(e57_out_field){ .field = { .name = strdup("rowIndex"), .maximum = rows - 1 },
									   .source = E57_OF_ROW,
									   .high = (double)(rows - 1) }));
	return add_field(
		m, s,
		&(e57_out_field){ .field = { .name = strdup("columnIndex"), .maximum = columns - 1 },
						  .source = E57_OF_CELL_COLUMN,
						  .high = (double)(columns - 1) });
}

static gw_status make_fields(maker *m, e57_out_scan *s)
{
	s->field = calloc(m->cloud->column_count + 3, sizeof *s->field);
	if (!s->field)
		return fail_memory(m);
	for (size_t c = 0; c < m->cloud->column_count; c++)
		GW_TRY(add_column(m, s, &m->cloud->column[c]));
	GW_TRY(add_others(m, s));
	for (e57_out_field *f = s->field; f < s->field + s->field_count; f++) {
		if (f->column)
			set_limits(m, s, f);
		find_bits(&f->field);
	}
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- sizes */

size_t e57_layout_stretch(const e57_out_field *field, size_t records)
{
	return (records * field->field.bits + 7) / 8;
}

size_t e57_layout_packet_head(const e57_out_scan *s)
{
	return 6 + 2 * s->field_count;
}

size_t e57_layout_packet(const e57_out_scan *s, size_t records)
{
	size_t bytes = e57_layout_packet_head(s);
	for (size_t f = 0; f < s->field_count; f++)
		bytes += e57_layout_stretch(&s->field[f], records);
	return (bytes + 3) / 4 * 4;
}

static gw_status find_sizes(maker *m, e57_out_scan *s)
{
	if (s->field_count > E57_FIELDS)
		return gw_fail(m->error, GW_ERROR_DATA,
					   "%s: %zu columns are more than the %d that a record of E57 has here; leave "
					   "some out, or write PLY",
					   m->name, s->field_count, E57_FIELDS);
	s->packet = PACKET_RECORDS;
	while (s->packet > PACKET_STEP && e57_layout_packet(s, s->packet) > PACKET_BYTES)
		s->packet -= PACKET_STEP;
	if (e57_layout_packet(s, s->packet) > PACKET_BYTES)
		return gw_fail(m->error, GW_ERROR_DATA,
					   "%s: %zu columns are too many for a packet of E57; leave some out, or write "
					   "PLY",
					   m->name, s->field_count);
	s->at = m->layout->length;
	s->length = E57_SECTION_HEAD + s->count / s->packet * e57_layout_packet(s, s->packet);
	if (s->count % s->packet)
		s->length += e57_layout_packet(s, s->count % s->packet);
	m->layout->length += s->length;
	return GW_OK;
}

static gw_status lay_out(const scan *cloud, const e57_known *known, const char *name,
						 e57_layout *layout, gw_error *error)
{
	*layout = (e57_layout){ .cloud = cloud, .length = E57_HEADER };
	maker m = { layout, cloud, name, known, error };
	GW_TRY(make_scans(&m));
	for (size_t s = 0; s < layout->scan_count; s++) {
		if (!known)
			layout->scan[s].image = find_image(layout, &layout->scan[s]);
		GW_TRY(make_fields(&m, &layout->scan[s]));
		GW_TRY(find_sizes(&m, &layout->scan[s]));
	}
	return GW_OK;
}

gw_status e57_layout_make(const scan *cloud, const char *name, e57_layout *layout, gw_error *error)
{
	return lay_out(cloud, NULL, name, layout, error);
}

gw_status e57_layout_of_part(const scan *part, const e57_known *known, const char *name,
							 e57_layout *layout, gw_error *error)
{
	return lay_out(part, known, name, layout, error);
}

void e57_layout_clear(e57_layout *layout)
{
	for (size_t s = 0; s < layout->scan_count; s++) {
		for (size_t f = 0; f < layout->scan[s].field_count; f++)
			free(layout->scan[s].field[f].field.name);
		free(layout->scan[s].field);
	}
	free(layout->scan);
	free(layout->order);
	*layout = (e57_layout){ .cloud = NULL };
}
