/*
 * PTX: grids of a scanner. Each begins with columns, rows, the scanner's position and axes, and a
 * matrix for row vectors; then a line for each cell.
 */
#include "files/growing_table.h"
#include "files/number_text.h"
#include "glowworm_host.h"
#include "points/scan_origin.h"
#include "text/text_columns.h"
#include "text/text_formats.h"
#include "text/text_stream.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEAD_BYTES (1 << 16)
#define HEADER_LINES 10

/* One grid. */
typedef struct grid {
	text_rows rows;
	double size[2];    /* columns and rows of cells */
	double matrix[16]; /* row vectors: the last row is the translation */
	size_t first;      /* point */
	size_t image;      /* of the cloud, where rows.cell is one */
} grid;

typedef struct reader {
	const input_file *in;
	const char *at, *end;
	size_t line; /* number of the line at `at` */
	char newline;
	grid *grid; /* owned; grid_count */
	size_t grid_count;
	size_t width; /* values of a row in the grid that has most */
	scan *cloud;
	gw_error *error;
} reader;

/* ------------------------------------------------------------------------------- headers */

/* The next line that is not blank. */
static bool next_line(reader *r, const char **line, size_t *length)
{
	while (text_rows_next_line(&r->at, r->end, r->newline, line, length)) {
		r->line++;
		if (!text_rows_is_empty(*line, *length))
			return true;
	}
	return false;
}

static gw_status take_numbers(reader *r, double *value, size_t count)
{
	const char *line;
	size_t length;
	if (!next_line(r, &line, &length))
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s ends in the header of scan %zu; the file is cut short", r->in->name,
					   r->grid_count + 1);
	bool good = text_rows_numbers(line, length, ' ', value, count) == count;
	for (size_t i = 0; good && i < count; i++)
		good = isfinite(value[i]);
	if (!good)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s, line %zu: %zu finite number%s expected in the header of scan %zu",
					   r->in->name, r->line - 1, count, count == 1 ? " was" : "s were",
					   r->grid_count + 1);
	return GW_OK;
}

static gw_status take_header(reader *r, grid *g)
{
	double position[12];
	for (size_t k = 0; k < 2; k++) {
		GW_TRY(take_numbers(r, &g->size[k], 1));
		if (!(g->size[k] >= 0.0 && g->size[k] <= 9e15 && g->size[k] == trunc(g->size[k])))
			return gw_fail(r->error, GW_ERROR_DATA,
						   "%s, line %zu: %s is no number of columns or rows", r->in->name,
						   r->line - 1, GW_SAID(g->size[k], 15));
	}
	for (size_t k = 0; k < 4; k++)
		GW_TRY(take_numbers(r, position + 3 * k, 3));
	for (size_t k = 0; k < 4; k++)
		GW_TRY(take_numbers(r, g->matrix + 4 * k, 4));
	const double *m = g->matrix;
	if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s, line %zu: the last column of the matrix of scan %zu is not 0 0 0 1, so "
					   "it does not move points",
					   r->in->name, r->line - 4, r->grid_count + 1);
	return GW_OK;
}

/* Steps over the lines of the cells. A line takes a byte and its end; only the last may lack it. */
static gw_status skip_cells(reader *r, const grid *g)
{
	double cells = g->size[0] * g->size[1];
	const char *line;
	size_t length, bytes = (size_t)(r->end - r->at);
	bool enough = cells <= (double)((bytes + 1) / 2);
	size_t count = enough ? (size_t)cells : 0, found = 0;
	while (found < count && next_line(r, &line, &length))
		found++;
	if (!enough || found < count)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s: scan %zu has %.0f x %.0f cells, but fewer lines follow its header, "
					   "which ends before line %zu; the file is cut short or the header is wrong: "
					   "tail -n +%zu FILE > rows.xyz leaves what rows there are, as a table to be "
					   "read with --columns x,y,z,intensity,red,green,blue",
					   r->in->name, r->grid_count + 1, g->size[0], g->size[1], g->rows.first_line,
					   g->rows.first_line);
	return GW_OK;
}

/* Values in the first row that is no hole; 3 when there is none. */
static size_t row_width(const text_rows *rows)
{
	const char *line;
	double value[16];
	size_t length;
	bool any = text_rows_first(rows, &line, &length);
	return any ? text_rows_numbers(line, length, ' ', value, 16) : 3;
}

/* The cells of a grid, whose lines are the next ones. */
static gw_status take_cells(reader *r, grid *header)
{
	grid g = *header;
	g.rows = (text_rows){ .in = r->in,
						  .begin = r->at,
						  .first_line = r->line,
						  .newline = r->newline,
						  .separator = ' ',
						  .skip = TEXT_ROWS_SKIP_ORIGIN };
	GW_TRY(skip_cells(r, &g));
	g.rows.end = r->at;
	g.rows.width = row_width(&g.rows);
	if (g.rows.width != 3 && g.rows.width != 4 && g.rows.width != 6 && g.rows.width != 7)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s, line %zu: rows of a PTX file have x y z, often an intensity, and often "
					   "red green blue; this one is none of them",
					   r->in->name, g.rows.first_line);
	grid *grown = growing_table_room(r->grid, r->grid_count, sizeof *grown);
	if (!grown)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the scans of %s", r->in->name);
	r->grid = grown;
	GW_TRY(text_rows_count(&g.rows, r->error));
	r->grid[r->grid_count++] = g;
	return GW_OK;
}

static gw_status take_grid(reader *r)
{
	grid g = { 0 };
	GW_TRY(take_header(r, &g));
	return take_cells(r, &g);
}

static bool at_end(const reader *r)
{
	reader ahead = *r;
	const char *line;
	size_t length;
	return !next_line(&ahead, &line, &length);
}

static void number_points(const reader *r)
{
	for (size_t i = 0; i < r->grid_count; i++) {
		grid *g = &r->grid[i];
		g->first = r->cloud->count;
		r->cloud->count += g->rows.count;
		r->cloud->left_out += g->rows.skipped;
	}
}

static gw_status take_grids(reader *r)
{
	gw_status status = GW_OK;
	do
		status = take_grid(r);
	while (status == GW_OK && !at_end(r));
	number_points(r);
	return status;
}

/* -------------------------------------------------------------------------------- points */

/* All columns that a grid has, for the whole cloud. */
static gw_status name_columns(reader *r, text_names *names)
{
	bool intensity = false, color = false;
	for (size_t i = 0; i < r->grid_count; i++) {
		intensity = intensity || r->grid[i].rows.width % 3 == 1;
		color = color || r->grid[i].rows.width >= 6;
	}
	char line[64];
	snprintf(line, sizeof line, "x y z%s%s", intensity ? " intensity" : "",
			 color ? " red green blue" : "");
	return text_names_split(names, line, strlen(line), r->error);
}

/* Points to the columns of one grid, from its first point on. What it lacks stays zero. */
static void aim(const text_names *names, text_column *all, const grid *g, text_column own[7])
{
	static const char *const order[7] = { "x", "y", "z", "intensity", "red", "green", "blue" };
	bool intensity = g->rows.width % 3 == 1;
	for (size_t c = 0; c < g->rows.width; c++) {
		const char *name = order[c < 3 || intensity ? c : c + 1];
		size_t i = 0;
		while (strcmp(names->name[i], name) != 0)
			i++;
		own[c] = (text_column){ .name = name,
								.type = SCAN_FLOAT64,
								.data = (double *)all[i].data + g->first,
								.whole = atomic_load(&all[i].whole),
								.single = atomic_load(&all[i].single) };
	}
}

static void keep_forms(const text_names *names, text_column *all, const grid *g, text_column own[7])
{
	for (size_t c = 0; c < g->rows.width; c++) {
		for (size_t i = 0; i < names->count; i++) {
			if (strcmp(names->name[i], own[c].name) != 0)
				continue;
			if (!atomic_load(&own[c].whole))
				atomic_store(&all[i].whole, false);
			if (!atomic_load(&own[c].single))
				atomic_store(&all[i].single, false);
		}
	}
}

static bool is_identity(const double m[16])
{
	for (int i = 0; i < 16; i++)
		if (m[i] != (i % 5 == 0 ? 1.0 : 0.0))
			return false;
	return true;
}

/* Moves points from the scanner's frame to the world; coordinates stay as they came when the matrix
 * moves nothing. */
static void move_points(const grid *g, double *x, double *y, double *z)
{
	const double *m = g->matrix;
	if (is_identity(m))
		return;
	for (size_t i = g->first; i < g->first + g->rows.count; i++) {
		double v[3] = { x[i], y[i], z[i] };
		x[i] = v[0] * m[0] + v[1] * m[4] + v[2] * m[8] + m[12];
		y[i] = v[0] * m[1] + v[1] * m[5] + v[2] * m[9] + m[13];
		z[i] = v[0] * m[2] + v[1] * m[6] + v[2] * m[10] + m[14];
	}
}

/* A grid is a picture; its cells are filled in when its rows are read. */
static gw_status add_image(reader *r, grid *g)
{
	gw_range_image image = { .first = g->first, .count = g->rows.count };
	if (g->rows.count == 0 || g->size[0] * g->size[1] >= (double)UINT32_MAX)
		return GW_OK;
	image.columns = (uint32_t)g->size[0];
	image.rows = (uint32_t)g->size[1];
	memcpy(image.scanner, &g->matrix[12], sizeof image.scanner);
	gw_status status = scan_add_image(r->cloud, &image, r->error);
	g->image = r->cloud->image_count - 1;
	g->rows.cell = status == GW_OK ? r->cloud->image_cell + g->first : NULL;
	return status;
}

/* Cells come column after column. */
static void number_cells(const reader *r, const grid *g)
{
	uint32_t columns = (uint32_t)g->size[0], rows = (uint32_t)g->size[1];
	for (size_t i = g->first; g->rows.cell && i < g->first + g->rows.count; i++) {
		uint32_t cell = r->cloud->image_cell[i];
		r->cloud->image_cell[i] = cell % rows * columns + cell / rows;
	}
}

static gw_status read_points(reader *r, const text_names *names, text_column *all)
{
	for (size_t i = 0; i < r->grid_count; i++) {
		text_column own[7];
		grid *g = &r->grid[i];
		aim(names, all, g, own);
		GW_TRY(add_image(r, g));
		GW_TRY(text_rows_read(&g->rows, own, r->error));
		number_cells(r, g);
		keep_forms(names, all, g, own);
		move_points(g, all[0].data, all[1].data, all[2].data);
	}
	return text_columns_narrow(r->cloud, names, all, r->error);
}

/* Whether the origin lies within the bounds of a grid's points, made larger by their size. */
static bool is_among(const grid *g, const scan *cloud)
{
	for (size_t k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (size_t i = g->first; i < g->first + g->rows.count; i++) {
			double value = scan_value(&cloud->column[k], i);
			low = value < low ? value : low;
			high = value > high ? value : high;
		}
		if (!(low - (high - low) <= 0.0 && high + (high - low) >= 0.0))
			return false;
	}
	return true;
}

/*
 * The matrix takes the scanner's place, its frame's origin, to the world. Points may never have
 * been in that frame, and then come with a matrix that does nothing: where they were seen from is
 * told by their rows and columns, or else not known if the origin is far off.
 */
static gw_status take_scanners(const reader *r)
{
	for (size_t i = 0; i < r->grid_count; i++) {
		const grid *g = &r->grid[i];
		const double *place = &g->matrix[12];
		bool known = !is_identity(g->matrix);
		if (!known && g->rows.cell && scan_settle_origin(r->cloud, g->image)) {
			place = r->cloud->image[g->image].scanner;
			known = true;
		}
		if (known || is_among(g, r->cloud))
			GW_TRY(scan_add_scanner(r->cloud, place, g->first, g->rows.count, r->error));
	}
	return GW_OK;
}

/* From the grids that were taken to points. */
static gw_status read_grids(reader *r)
{
	text_names names = { 0 };
	text_column *column = NULL;
	gw_status status = name_columns(r, &names);
	if (status == GW_OK)
		status = text_columns_add(r->cloud, &names, &column, r->error);
	if (status == GW_OK)
		status = read_points(r, &names, column);
	free(column);
	text_names_clear(&names);
	return status;
}

static void clear_grids(reader *r)
{
	for (size_t i = 0; i < r->grid_count; i++)
		text_rows_clear(&r->grid[i].rows);
	r->grid_count = 0;
}

static reader reader_of(const input_file *in, gw_error *error)
{
	const char *text = text_rows_begin(in->data, in->length);
	const char *end = (const char *)in->data + in->length;
	return (reader){ .in = in,
					 .at = text,
					 .end = end,
					 .line = 1,
					 .newline = text_rows_newline(text, end),
					 .error = error };
}

gw_status ptx_read(input_file *in, scan *cloud, gw_error *error)
{
	reader r = reader_of(in, error);
	r.cloud = cloud;
	*cloud = (scan){ .up = 'z' };
	gw_status status = take_grids(&r);
	if (status == GW_OK)
		status = read_grids(&r);
	if (status == GW_OK)
		status = take_scanners(&r);
	clear_grids(&r);
	free(r.grid);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

/* ------------------------------------------------------------------------------ piece by piece */

/* A file that is read so: some columns of a grid at a time, which are a grid of their own. */
typedef struct stream {
	reader reader;
	grid grid;   /* the one that is being read: its header */
	bool begun;  /* there is one */
	double left; /* columns of it */
	scan_first_scanner scanner;
} stream;

static gw_status next_grid(stream *t)
{
	t->grid = (grid){ .first = 0 };
	t->begun = true;
	t->scanner = (scan_first_scanner){ .looked = false };
	GW_TRY(take_header(&t->reader, &t->grid));
	t->left = t->grid.size[1] > 0.0 ? t->grid.size[0] : 0.0;
	return GW_OK;
}

static gw_status read_columns(stream *t, size_t most)
{
	reader *r = &t->reader;
	grid g = t->grid;
	double columns = fmax(floor((double)most / g.size[1]), 1.0);
	g.size[0] = fmin(columns, t->left);
	t->left -= g.size[0];
	GW_TRY(take_cells(r, &g));
	number_points(r);
	if (r->cloud->count == 0)
		return GW_OK;
	GW_TRY(read_grids(r));
	if (!t->scanner.looked)
		GW_TRY(take_scanners(r));
	return scan_keep_scanner(&t->scanner, r->cloud, r->error);
}

static gw_status stream_next(void *state, size_t most, scan *piece, gw_error *error)
{
	stream *t = state;
	reader *r = &t->reader;
	gw_status status = GW_OK;
	r->cloud = piece;
	r->error = error;
	*piece = (scan){ .up = 'z' };
	while (status == GW_OK && piece->count == 0 && (t->left > 0.0 || !t->begun || !at_end(r))) {
		const char *before = r->at;
		status = t->left > 0.0 ? read_columns(t, most) : next_grid(t);
		clear_grids(r);
		input_file_release(r->in, before, r->at);
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
	t->reader = reader_of(in, error);
	return GW_OK;
}

static void stream_close(void *state)
{
	stream *t = state;
	if (t)
		free(t->reader.grid);
	free(t);
}

static const format_stream ptx_stream = { text_stream_guess, stream_open, stream_next,
										  stream_close };

/* Lines of one, one, four times three and four times four numbers. */
static bool probe(const uint8_t *data, size_t length)
{
	static const size_t width[HEADER_LINES] = { 1, 1, 3, 3, 3, 3, 4, 4, 4, 4 };
	const char *at = (const char *)data, *line;
	size_t line_length;
	double value[4];
	length = length < HEAD_BYTES ? length : HEAD_BYTES;
	const char *end = at + length;
	char newline = text_rows_newline(at, end);
	for (int i = 0; i < HEADER_LINES; i++)
		if (!text_rows_next_line(&at, end, newline, &line, &line_length) || line_length > 1000 ||
			text_rows_numbers(line, line_length, ' ', value, 4) != width[i])
			return false;
	return true;
}

static const char *const extensions[] = { "ptx", NULL };

const format ptx_format = {
	.name = "ptx",
	.description = "grids of a scanner as text, with position and matrix",
	.extensions = extensions,
	.probe = probe,
	.read = ptx_read,
	.stream = &ptx_stream,
};
