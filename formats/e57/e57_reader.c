/*
 * E57: from the records of all scans to one table of points. Every count is checked against the
 * bytes that its fields have before anything is allocated for it.
 */
#include "e57/e57_description.h"
#include "e57/e57_format.h"
#include "e57/e57_source.h"
#include "glowworm_host.h"
#include "points/scan_origin.h"
#include "text/text_columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum coordinates { CARTESIAN, SPHERICAL } coordinates;

/* One scan on its way. */
typedef struct source {
	const e57_scan *scan;
	e57_source records;
	coordinates kind;
	size_t position[3]; /* fields x y z, or range azimuth elevation */
	size_t invalid;     /* field that says which records have none, or SIZE_MAX */
	size_t first, kept; /* points */
} source;

typedef struct reader {
	const input_file *in;
	e57_pages pages;
	e57_description description;
	source *source; /* owned; description.scan_count */
	uint64_t count; /* records of all */
	text_names names;
	text_column *column; /* owned; names.count */
	uint8_t *invalid;    /* owned; one a point */
	scan *cloud;
	gw_error *error;
} reader;

static gw_status fail_scan(const reader *r, size_t index, const char *what)
{
	return e57_source_fail(&r->pages, index, what, r->error);
}

static gw_status fail_memory(const reader *r)
{
	return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the points of %s", r->in->name);
}

/* -------------------------------------------------------------------------------- fields */

static size_t find_field(const e57_scan *records, const char *name)
{
	for (size_t f = 0; f < records->field_count; f++)
		if (strcmp(records->field[f].name, name) == 0 && records->field[f].type != E57_STRING)
			return f;
	return SIZE_MAX;
}

static bool find_position(source *s)
{
	static const char *const names[2][4] = {
		{ "cartesianX", "cartesianY", "cartesianZ", "cartesianInvalidState" },
		{ "sphericalRange", "sphericalAzimuth", "sphericalElevation", "sphericalInvalidState" }
	};
	for (int kind = CARTESIAN; kind <= SPHERICAL; kind++) {
		bool all = true;
		for (int k = 0; k < 3; k++) {
			s->position[k] = find_field(s->scan, names[kind][k]);
			all = all && s->position[k] != SIZE_MAX;
		}
		s->kind = (coordinates)kind;
		s->invalid = find_field(s->scan, names[kind][3]);
		if (all)
			return true;
	}
	return false;
}

static gw_status prepare_source(reader *r, size_t index)
{
	source *s = &r->source[index];
	s->scan = &r->description.scan[index];
	gw_status status = e57_source_open(&s->records, &r->pages, s->scan, index, r->error);
	if (status != GW_OK || s->scan->count == 0)
		return status;
	if (!find_position(s))
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s: the records of scan %zu have neither cartesian nor spherical "
					   "coordinates",
					   r->in->name, index + 1);
	r->count += s->scan->count;
	return status;
}

/* The column's name for a field, or NULL for those that points are made of. */
static const char *column_name(const source *s, size_t field)
{
	static const char *const known[][2] = {
		{ "colorRed", "red" },
		{ "colorGreen", "green" },
		{ "colorBlue", "blue" },
		{ "nor:normalX", "nx" },
		{ "nor:normalY", "ny" },
		{ "nor:normalZ", "nz" },
		{ "sphericalRange", NULL },
		{ "sphericalAzimuth", NULL },
		{ "sphericalElevation", NULL },
		{ "cartesianInvalidState", NULL },
		{ "sphericalInvalidState", NULL },
		{ "cartesianX", NULL },
		{ "cartesianY", NULL },
		{ "cartesianZ", NULL },
	};
	const e57_field *f = &s->scan->field[field];
	if (f->type == E57_STRING)
		return NULL;
	if (f->column)
		return f->column;
	for (size_t k = 0; k < sizeof known / sizeof *known; k++)
		if (strcmp(f->name, known[k][0]) == 0)
			return known[k][1];
	return f->name;
}

static size_t find_name(const text_names *names, const char *name)
{
	size_t i = 0;
	while (i < names->count && strcmp(names->name[i], name) != 0)
		i++;
	return i;
}

/* Columns for x, y, z and every field that a scan has. */
static gw_status name_columns(reader *r)
{
	GW_TRY(text_names_split(&r->names, "x y z", 5, r->error));
	for (size_t i = 0; i < r->description.scan_count; i++) {
		const source *s = &r->source[i];
		for (size_t f = 0; f < s->scan->field_count && s->scan->count > 0; f++) {
			const char *name = column_name(s, f);
			if (!name || find_name(&r->names, name) < r->names.count)
				continue;
			if (r->names.count == TEXT_COLUMNS_MAX)
				return fail_scan(r, i, "has more than 4096 different fields");
			GW_TRY(text_names_add(&r->names, name, r->error));
		}
	}
	return GW_OK;
}

/* Opens the file: what is in it, but for the records. */
static gw_status open_scans(reader *r)
{
	GW_TRY(e57_pages_open(&r->pages, r->in, r->error));
	GW_TRY(e57_pages_check(&r->pages, r->error));
	GW_TRY(e57_description_parse(&r->description, &r->pages, r->in, r->error));
	r->source = calloc(r->description.scan_count + 1, sizeof *r->source);
	if (!r->source)
		return fail_memory(r);
	for (size_t i = 0; i < r->description.scan_count; i++)
		GW_TRY(prepare_source(r, i));
	GW_TRY(name_columns(r));
	const char *twice = text_names_repeated(&r->names);
	return twice ? gw_fail(r->error, GW_ERROR_DATA, "%s: two fields are called '%.40s'",
						   r->in->name, twice)
				 : GW_OK;
}

static gw_status add_columns(reader *r)
{
	/* A field that takes one bit becomes a double first. */
	uint64_t bytes, available = gw_available_memory();
	if (__builtin_mul_overflow((uint64_t)r->cloud->count, 8 * r->names.count + 1, &bytes) ||
		(available && bytes > available))
		return fail_memory(r);
	r->invalid = calloc(r->cloud->count ? r->cloud->count : 1, 1);
	if (!r->invalid)
		return fail_memory(r);
	return text_columns_add(r->cloud, &r->names, &r->column, r->error);
}

/* -------------------------------------------------------------------------------- points */

static void unpack(const reader *r, const source *s, size_t field, double *to)
{
	e57_source_unpack(&s->records, field, r->in->threads, to);
}

static void read_fields(reader *r, const source *s)
{
	for (size_t f = 0; f < s->scan->field_count; f++) {
		const char *name = column_name(s, f);
		if (!name)
			continue;
		text_column *to = &r->column[find_name(&r->names, name)];
		e57_type type = s->scan->field[f].type;
		if (type != E57_INTEGER)
			to->whole = false;
		if (type != E57_SINGLE)
			to->single = false;
		unpack(r, s, f, (double *)to->data + s->first);
	}
	for (size_t k = 0; k < 3; k++)
		unpack(r, s, s->position[k], (double *)r->column[k].data + s->first);
}

/* Records whose state is not 0 have no position. */
static gw_status read_states(reader *r, const source *s)
{
	if (s->invalid == SIZE_MAX)
		return GW_OK;
	double *state = reallocarray(NULL, s->kept, sizeof *state);
	if (!state)
		return fail_memory(r);
	unpack(r, s, s->invalid, state);
	for (size_t i = 0; i < s->kept; i++)
		r->invalid[s->first + i] = state[i] != 0.0;
	free(state);
	return GW_OK;
}

/* Rows of the rotation matrix of a quaternion of any length; false for none. */
static bool make_rotation(const double q[4], double m[9])
{
	double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
	if (!(n > 0.0) || !isfinite(n))
		return false;
	double s = 2.0 / n, w = q[0], x = q[1], y = q[2], z = q[3];
	const double rows[9] = { 1 - s * (y * y + z * z), s * (x * y - w * z),
							 s * (x * z + w * y),     s * (x * y + w * z),
							 1 - s * (x * x + z * z), s * (y * z - w * x),
							 s * (x * z - w * y),     s * (y * z + w * x),
							 1 - s * (x * x + y * y) };
	memcpy(m, rows, sizeof rows);
	return true;
}

static void turn(const double m[9], const double shift[3], double *const v[3], size_t i)
{
	const double p[3] = { v[0][i], v[1][i], v[2][i] };
	for (int k = 0; k < 3; k++)
		v[k][i] = m[3 * k] * p[0] + m[3 * k + 1] * p[1] + m[3 * k + 2] * p[2] + shift[k];
}

static void from_sphere(double *const v[3], size_t i)
{
	double range = v[0][i], azimuth = v[1][i], elevation = v[2][i];
	v[0][i] = range * cos(elevation) * cos(azimuth);
	v[1][i] = range * cos(elevation) * sin(azimuth);
	v[2][i] = range * sin(elevation);
}

/* The three columns of a vector from a scan's first point on; false when one is missing. */
static bool aim(const reader *r, const source *s, const char *const name[3], double *v[3])
{
	for (size_t k = 0; k < 3; k++) {
		size_t i = find_name(&r->names, name[k]);
		if (i == r->names.count)
			return false;
		v[k] = (double *)r->column[i].data + s->first;
	}
	return true;
}

static gw_status place_points(const reader *r, const source *s, size_t index)
{
	static const char *const position[3] = { "x", "y", "z" }, *const normal[3] = { "nx", "ny",
																				   "nz" };
	static const double nowhere[3] = { 0 };
	const double *q = s->scan->rotation;
	double m[9], *v[3];
	if (!make_rotation(q, m))
		return fail_scan(r, index, "has a pose whose rotation makes no sense");
	bool turned = q[1] != 0.0 || q[2] != 0.0 || q[3] != 0.0;
	if (!aim(r, s, position, v))
		return fail_scan(r, index, "has no coordinates");
	for (size_t i = 0; i < s->kept && s->kind == SPHERICAL; i++)
		from_sphere(v, i);
	for (size_t i = 0; i < s->kept && s->scan->has_pose; i++)
		turn(m, s->scan->translation, v, i);
	if (!turned || !aim(r, s, normal, v))
		return GW_OK;
	for (size_t i = 0; i < s->kept; i++)
		turn(m, nowhere, v, i);
	for (size_t k = 0; k < 3; k++)
		r->column[find_name(&r->names, normal[k])].single = false;
	return GW_OK;
}

/* Closes the gaps that invalid records leave. */
static void leave_out(reader *r)
{
	for (size_t c = 0; c < r->cloud->column_count; c++) {
		double *value = r->cloud->column[c].data;
		size_t to = 0;
		for (size_t i = 0; i < r->cloud->count; i++)
			if (!r->invalid[i])
				value[to++] = value[i];
	}
	size_t first = 0;
	for (size_t i = 0; i < r->description.scan_count; i++) {
		source *s = &r->source[i];
		size_t invalid = 0;
		for (size_t k = 0; k < s->kept; k++)
			invalid += r->invalid[s->first + k];
		s->kept -= invalid;
		s->first = first;
		first += s->kept;
		r->cloud->left_out += invalid;
	}
	r->cloud->count = first;
}

/* The least and the largest value of a scan's field, which has to have whole ones. */
static bool find_limits(const reader *r, const source *s, const char *name, double limit[2])
{
	const scan_column *column = scan_find(r->cloud, name);
	limit[0] = INFINITY;
	limit[1] = -INFINITY;
	for (size_t i = s->first; column && i < s->first + s->kept; i++) {
		double value = scan_value(column, i);
		if (value != trunc(value))
			return false;
		limit[0] = fmin(limit[0], value);
		limit[1] = fmax(limit[1], value);
	}
	return column && limit[1] - limit[0] < 1e9;
}

/* Rows and columns make a scan a picture, which is seen from the origin of its frame. */
static gw_status add_image(const reader *r, const source *s, bool *added)
{
	double row[2], column[2];
	*added = false;
	if (!find_limits(r, s, "rowIndex", row) || !find_limits(r, s, "columnIndex", column) ||
		(row[1] - row[0] + 1.0) * (column[1] - column[0] + 1.0) >= (double)UINT32_MAX)
		return GW_OK;
	gw_range_image image = { .first = s->first,
							 .count = s->kept,
							 .columns = (uint32_t)(column[1] - column[0]) + 1,
							 .rows = (uint32_t)(row[1] - row[0]) + 1 };
	memcpy(image.scanner, s->scan->translation, sizeof image.scanner);
	GW_TRY(scan_add_image(r->cloud, &image, r->error));
	const scan_column *const index[2] = { scan_find(r->cloud, "rowIndex"),
										  scan_find(r->cloud, "columnIndex") };
	for (size_t i = s->first; i < s->first + s->kept; i++)
		r->cloud->image_cell[i] = (uint32_t)(scan_value(index[0], i) - row[0]) * image.columns +
								  (uint32_t)(scan_value(index[1], i) - column[0]);
	*added = true;
	return GW_OK;
}

/*
 * A scanner stands at the origin of its scan's frame. But without a pose, and with one that moves
 * nothing, points may be in that frame or in a common one: their rows and columns tell.
 */
static gw_status take_scanner(const reader *r, const source *s)
{
	const double *place = s->scan->translation;
	bool known = s->kind == SPHERICAL, added, moves_nothing = true;
	for (size_t k = 0; k < 3; k++)
		moves_nothing = moves_nothing && place[k] == 0.0;
	if (s->kept == 0)
		return GW_OK;
	GW_TRY(add_image(r, s, &added));
	size_t last = r->cloud->image_count - 1;
	if (!known && added && moves_nothing && scan_settle_origin(r->cloud, last)) {
		place = r->cloud->image[last].scanner;
		known = true;
	}
	if (!known && !s->scan->has_pose)
		return GW_OK;
	return scan_add_scanner(r->cloud, place, s->first, s->kept, r->error);
}

/* -------------------------------------------------------------------------------- all at once */

/* The records that a scan holds become points from s->first on. */
static gw_status read_records(reader *r, size_t index)
{
	source *s = &r->source[index];
	read_fields(r, s);
	GW_TRY(read_states(r, s));
	return place_points(r, s, index);
}

static gw_status take_comments(const reader *r)
{
	for (size_t c = 0; c < r->description.comment_count; c++)
		GW_TRY(scan_add_comment(r->cloud, r->description.comment[c], r->error));
	return GW_OK;
}

static gw_status read_all(reader *r)
{
	GW_TRY(open_scans(r));
	r->cloud->count = (size_t)r->count;
	GW_TRY(add_columns(r));
	size_t first = 0;
	for (size_t i = 0; i < r->description.scan_count; i++) {
		source *s = &r->source[i];
		if (s->scan->count == 0)
			continue;
		GW_TRY(e57_source_take(&s->records, (size_t)s->scan->count, r->error));
		s->first = first;
		s->kept = s->records.held;
		first += s->kept;
		GW_TRY(read_records(r, i));
		e57_source_clear(&s->records);
	}
	leave_out(r);
	GW_TRY(take_comments(r));
	GW_TRY(text_columns_narrow(r->cloud, &r->names, r->column, r->error));
	for (size_t i = 0; i < r->description.scan_count; i++)
		GW_TRY(take_scanner(r, &r->source[i]));
	return GW_OK;
}

static void clear_points(reader *r)
{
	free(r->column);
	free(r->invalid);
	r->column = NULL;
	r->invalid = NULL;
}

static void clear_reader(reader *r)
{
	for (size_t i = 0; r->source && i < r->description.scan_count; i++)
		e57_source_clear(&r->source[i].records);
	free(r->source);
	clear_points(r);
	text_names_clear(&r->names);
	e57_description_clear(&r->description);
}

gw_status e57_read(input_file *in, scan *cloud, gw_error *error)
{
	reader r = { .in = in, .cloud = cloud, .error = error };
	*cloud = (scan){ .up = 'z' };
	gw_status status = read_all(&r);
	clear_reader(&r);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

/* ------------------------------------------------------------------------------ piece by piece */

/* A file that is read so. */
typedef struct stream {
	reader reader;
	size_t scan;                 /* that comes next */
	scan_first_scanner *scanner; /* owned; of each */
} stream;

static gw_status read_piece(stream *t, size_t most)
{
	reader *r = &t->reader;
	source *s = &r->source[t->scan];
	scan_first_scanner *scanner = &t->scanner[t->scan];
	GW_TRY(e57_source_take(&s->records, most, r->error));
	s->first = 0;
	s->kept = r->cloud->count = s->records.held;
	GW_TRY(add_columns(r));
	GW_TRY(read_records(r, t->scan));
	leave_out(r);
	GW_TRY(take_comments(r));
	GW_TRY(text_columns_narrow(r->cloud, &r->names, r->column, r->error));
	if (!scanner->looked)
		GW_TRY(take_scanner(r, s));
	return scan_keep_scanner(scanner, r->cloud, r->error);
}

/* The next scan that has records left; false when there is none. */
static bool find_scan(stream *t)
{
	const reader *r = &t->reader;
	while (t->scan < r->description.scan_count) {
		source *s = &r->source[t->scan];
		if (s->records.taken < s->scan->count)
			return true;
		e57_source_clear(&s->records);
		s->kept = 0;
		t->scan++;
	}
	return false;
}

static gw_status stream_next(void *state, size_t most, scan *piece, gw_error *error)
{
	stream *t = state;
	reader *r = &t->reader;
	gw_status status = GW_OK;
	r->cloud = piece;
	r->error = error;
	*piece = (scan){ .up = 'z' };
	/* A piece without a point would say that there are no more. */
	while (status == GW_OK && piece->count == 0 && find_scan(t)) {
		uint64_t left_out = piece->left_out;
		scan_clear(piece);
		*piece = (scan){ .up = 'z', .left_out = left_out };
		status = read_piece(t, most);
		clear_points(r);
	}
	if (status != GW_OK)
		scan_clear(piece);
	return status;
}

static gw_status stream_open(input_file *in, void **state, gw_error *error)
{
	stream *t = calloc(1, sizeof *t);
	*state = t;
	if (!t)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to read %s", in->name);
	t->reader = (reader){ .in = in, .error = error };
	GW_TRY(open_scans(&t->reader));
	size_t count = t->reader.description.scan_count + 1;
	t->scanner = calloc(count, sizeof *t->scanner);
	return t->scanner ? GW_OK : fail_memory(&t->reader);
}

static void stream_close(void *state)
{
	stream *t = state;
	if (!t)
		return;
	clear_reader(&t->reader);
	free(t->scanner);
	free(t);
}

/* By the description alone: damage is told by who reads the records. */
static uint64_t stream_guess(input_file *in)
{
	reader r = { .in = in };
	uint64_t count = 0;
	if (e57_pages_open(&r.pages, in, NULL) == GW_OK &&
		e57_description_parse(&r.description, &r.pages, in, NULL) == GW_OK)
		for (size_t i = 0; i < r.description.scan_count; i++)
			count += r.description.scan[i].count;
	e57_description_clear(&r.description);
	return count;
}

static const format_stream e57_stream = { stream_guess, stream_open, stream_next, stream_close };

static bool probe(const uint8_t *head, size_t length)
{
	return length >= 8 && memcmp(head, "ASTM-E57", 8) == 0;
}

static const char *const extensions[] = { "e57", NULL };

const format e57_format = {
	.name = "e57",
	.description = "3D imaging data, ASTM E2807",
	.extensions = extensions,
	.probe = probe,
	.read = e57_read,
	.stream = &e57_stream,
	.write = e57_write,
	.parted = &e57_parted,
};
