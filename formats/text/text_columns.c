#include "text/text_columns.h"
#include "points/column_names.h"
#include "files/growing_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rows that are looked at, and the most columns, before columns are named by their values. */
#define SAMPLE_ROWS 1000
#define SAMPLE_COLUMNS 64

/* --------------------------------------------------------------------------------- names */

gw_status text_names_add(text_names *names, const char *text, gw_error *error)
{
	char **grown = growing_table_room(names->name, names->count, sizeof *grown);
	if (grown)
		names->name = grown;
	char *copy = grown ? strdup(text) : NULL;
	if (!copy)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the names of columns");
	names->name[names->count++] = copy;
	return GW_OK;
}

/* Adds a word of a line, known ones as the canonical name. */
static gw_status add_word(text_names *names, const char *text, size_t length, gw_error *error)
{
	char *own = strndup(text, length);
	if (!own)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the names of columns");
	gw_status status = text_names_add(names, column_table_name(own), error);
	free(own);
	return status;
}

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '"';
}

static bool parts(char c, char separator)
{
	return separator == ' ' ? is_blank(c) : c == separator;
}

/* r, g and b together are colours; one of them alone can be anything. */
static gw_status name_colors(text_names *names, gw_error *error)
{
	static const char *const color[3] = { "red", "green", "blue" };
	char **place[3] = { NULL, NULL, NULL };
	for (size_t i = 0; i < names->count; i++)
		for (size_t k = 0; k < 3; k++)
			if (strlen(names->name[i]) == 1 && (names->name[i][0] | 32) == color[k][0])
				place[k] = &names->name[i];
	for (size_t k = 0; k < 3 && place[0] && place[1] && place[2]; k++) {
		char *copy = strdup(color[k]);
		if (!copy)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the names of columns");
		free(*place[k]);
		*place[k] = copy;
	}
	return GW_OK;
}

gw_status text_names_split(text_names *names, const char *line, size_t length, gw_error *error)
{
	const char *at = line, *end = line + length;
	char separator = text_rows_separator(line, length);
	gw_status status = GW_OK;
	*names = (text_names){ 0 };
	while (at < end && (is_blank(*at) || *at == '#' || *at == '/'))
		at++;
	while (at < end && status == GW_OK && names->count <= TEXT_COLUMNS_MAX) {
		while (at < end && is_blank(*at))
			at++;
		const char *first = at;
		while (at < end && !parts(*at, separator))
			at++;
		const char *last = at;
		while (last > first && is_blank(last[-1]))
			last--;
		at += at < end;
		if (last > first || separator != ' ')
			status = add_word(names, first, (size_t)(last - first), error);
	}
	if (status == GW_OK)
		status = name_colors(names, error);
	if (status != GW_OK)
		text_names_clear(names);
	return status;
}

static bool has_name(const text_names *names, const char *name)
{
	for (size_t i = 0; i < names->count; i++)
		if (strcmp(names->name[i], name) == 0)
			return true;
	return false;
}

const char *text_names_repeated(const text_names *names)
{
	for (size_t i = 0; i < names->count; i++)
		for (size_t j = 0; j < i; j++)
			if (strcmp(names->name[i], names->name[j]) == 0 && strcmp(names->name[i], "-") != 0)
				return names->name[i];
	return NULL;
}

bool text_names_have_position(const text_names *names)
{
	return has_name(names, "x") && has_name(names, "y") && has_name(names, "z");
}

void text_names_clear(text_names *names)
{
	for (size_t i = 0; i < names->count; i++)
		free(names->name[i]);
	free(names->name);
	*names = (text_names){ 0 };
}

/* ------------------------------------------------------------------------------- guessing */

/* What is known of a column and the two behind it. */
typedef struct triple {
	bool bytes;     /* all three whole and 0 to 255, and written alike: with a point or without */
	bool fractions; /* all three 0 to 1 */
	bool negative;  /* one of them, at least once */
	size_t unit;    /* rows in which their length is 1 within 2 percent */
	size_t beyond;  /* rows in which it is more */
} triple;

static void judge_triple(triple *t, const double v[3], const number_form form[3])
{
	double squared = 0.0;
	t->bytes = t->bytes && form[0].whole == form[1].whole && form[1].whole == form[2].whole;
	for (int k = 0; k < 3; k++) {
		t->bytes = t->bytes && v[k] >= 0.0 && v[k] <= 255.0 && v[k] == trunc(v[k]);
		t->fractions = t->fractions && v[k] >= 0.0 && v[k] <= 1.0;
		t->negative = t->negative || v[k] < 0.0;
		squared += v[k] * v[k];
	}
	double length = sqrt(squared);
	t->unit += fabs(length - 1.0) <= 0.02;
	t->beyond += !(length <= 1.02);
}

/* Judges every triple of columns by the first rows. Returns the number of rows. */
static size_t judge(text_rows *rows, triple t[SAMPLE_COLUMNS])
{
	const char *at = rows->begin, *line;
	size_t length, count = 0;
	for (size_t c = 0; c < SAMPLE_COLUMNS; c++)
		t[c] = (triple){ .bytes = true, .fractions = true };
	rows->width = 0;
	while (count < SAMPLE_ROWS &&
		   text_rows_next_line(&at, rows->end, rows->newline, &line, &length)) {
		double value[SAMPLE_COLUMNS];
		number_form form[SAMPLE_COLUMNS];
		if (text_rows_is_empty(line, length))
			continue;
		size_t width = text_rows_forms(line, length, rows->separator, value, form, SAMPLE_COLUMNS);
		if (width == 0 || (rows->skip == TEXT_ROWS_SKIP_SINGLE && width == 1))
			continue;
		if (rows->width == 0)
			rows->width = width;
		for (size_t c = 3; c + 2 < width && width == rows->width; c++)
			judge_triple(&t[c], value + c, form + c);
		count++;
	}
	return count;
}

static bool are_normals(const triple *t, size_t rows)
{
	return t->unit * 10 >= rows * 9 || (t->beyond == 0 && t->negative);
}

static gw_status add_names(text_names *names, const char *const *name, gw_error *error)
{
	for (size_t k = 0; k < 3; k++)
		GW_TRY(text_names_add(names, name[k], error));
	return GW_OK;
}

static gw_status guess(text_names *names, const text_rows *rows, const triple *t, size_t count,
					   bool intensity_first, gw_error *error)
{
	static const char *const position[3] = { "x", "y", "z" },
							 *const normal[3] = { "nx", "ny", "nz" },
							 *const color[3] = { "red", "green", "blue" };
	bool colors = false, normals = false;
	GW_TRY(add_names(names, position, error));
	while (names->count < rows->width) {
		size_t c = names->count;
		bool three = c + 2 < rows->width && !(intensity_first && c == 3 && rows->width >= 7);
		if (three && !normals && are_normals(&t[c], count)) {
			normals = true;
			GW_TRY(add_names(names, normal, error));
		} else if (three && !colors && (t[c].bytes || t[c].fractions)) {
			colors = true;
			GW_TRY(add_names(names, color, error));
		} else {
			bool before_color = c + 3 < rows->width && (t[c + 1].bytes || t[c + 1].fractions);
			bool is_intensity = c == 3 && (rows->width == 4 || before_color || intensity_first);
			char name[32];
			snprintf(name, sizeof name, "field_%zu", c + 1);
			GW_TRY(text_names_add(names, is_intensity ? "intensity" : name, error));
		}
	}
	return GW_OK;
}

gw_status text_names_guess(text_names *names, text_rows *rows, bool intensity_first,
						   gw_error *error)
{
	triple t[SAMPLE_COLUMNS];
	*names = (text_names){ 0 };
	size_t count = judge(rows, t);
	if (rows->width < 3)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: no line has from 3 to %d numbers, of which the first three could be "
					   "coordinates; if it is a table of points, name its columns with --columns",
					   rows->in->name, SAMPLE_COLUMNS);
	gw_status status = guess(names, rows, t, count, intensity_first, error);
	if (status != GW_OK)
		text_names_clear(names);
	return status;
}

/* ------------------------------------------------------------------------------- columns */

static bool is_position(const char *name)
{
	return name[0] >= 'x' && name[0] <= 'z' && !name[1];
}

gw_status text_columns_add(scan *cloud, const text_names *names, text_column **column,
						   gw_error *error)
{
	text_column *made = calloc(names->count, sizeof *made);
	*column = NULL;
	if (!made)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu columns", names->count);
	for (size_t i = 0; i < names->count; i++) {
		made[i] = (text_column){
			.name = names->name[i],
			.type = SCAN_FLOAT64,
			.whole = !is_position(names->name[i]),
			.single = !is_position(names->name[i]),
		};
		if (strcmp(names->name[i], "-") == 0)
			continue;
		scan_column *to = scan_add_column(cloud, names->name[i], SCAN_FLOAT64, error);
		if (!to) {
			free(made);
			return GW_ERROR_MEMORY;
		}
		made[i].data = to->data;
	}
	*column = made;
	return GW_OK;
}

static scan_type smallest_type(const scan_column *column, size_t count, bool whole, bool single)
{
	static const struct {
		scan_type type;
		double minimum, maximum;
	} fits[] = { { SCAN_UINT8, 0, UINT8_MAX },   { SCAN_INT8, INT8_MIN, INT8_MAX },
				 { SCAN_UINT16, 0, UINT16_MAX }, { SCAN_INT16, INT16_MIN, INT16_MAX },
				 { SCAN_UINT32, 0, UINT32_MAX }, { SCAN_INT32, INT32_MIN, INT32_MAX } };
	double minimum = 0.0, maximum = 0.0;
	const double *value = column->data;
	for (size_t i = 0; whole && i < count; i++) {
		minimum = value[i] < minimum ? value[i] : minimum;
		maximum = value[i] > maximum ? value[i] : maximum;
	}
	for (size_t f = 0; whole && f < sizeof fits / sizeof *fits; f++)
		if (minimum >= fits[f].minimum && maximum <= fits[f].maximum)
			return fits[f].type;
	return single ? SCAN_FLOAT32 : SCAN_FLOAT64;
}

static gw_status narrow(scan_column *column, size_t count, scan_type type, gw_error *error)
{
	scan_column narrow = { .name = column->name, .type = type };
	narrow.data = reallocarray(NULL, count ? count : 1, scan_type_size(type));
	if (!narrow.data)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the column '%s'", column->name);
	for (size_t i = 0; i < count; i++)
		scan_store(&narrow, i, ((const double *)column->data)[i]);
	free(column->data);
	*column = narrow;
	return GW_OK;
}

gw_status text_columns_narrow(scan *cloud, const text_names *names, text_column *column,
							  gw_error *error)
{
	for (size_t i = 0; i < names->count; i++) {
		if (!column[i].data || is_position(names->name[i]))
			continue;
		scan_column *own = scan_find(cloud, names->name[i]);
		scan_type type = smallest_type(own, cloud->count, atomic_load(&column[i].whole),
									   atomic_load(&column[i].single));
		if (type != SCAN_FLOAT64)
			GW_TRY(narrow(own, cloud->count, type, error));
	}
	return GW_OK;
}

gw_status text_columns_read(text_rows *rows, const text_names *names, scan *cloud, gw_error *error)
{
	text_column *column;
	GW_TRY(text_columns_add(cloud, names, &column, error));
	gw_status status = text_rows_read(rows, column, error);
	if (status == GW_OK)
		status = text_columns_narrow(cloud, names, column, error);
	free(column);
	return status;
}
