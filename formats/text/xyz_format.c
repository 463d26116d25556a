/*
 * XYZ and CSV: tables of which nobody says what they hold but their first line, if that.
 */
#include "files/number_text.h"
#include "text/text_formats.h"
#include "text/text_stream.h"

#include <stdlib.h>
#include <string.h>

/* Bytes at the start of a file that are looked at. */
#define HEAD_BYTES (1 << 16)

/* The lines before the first row. */
typedef struct head {
	const char *comment; /* the last comment before the first other line */
	size_t comment_length;
	const char *line; /* that line: names or values */
	size_t length;
	size_t number;      /* of that line */
	const char *behind; /* that line */
} head;

static bool find_head(const text_rows *rows, head *h)
{
	const char *at = rows->begin, *line;
	size_t length;
	*h = (head){ 0 };
	while (text_rows_next_line(&at, rows->end, rows->newline, &line, &length)) {
		h->number++;
		if (!text_rows_is_empty(line, length)) {
			h->line = line;
			h->length = length;
			h->behind = at;
			return true;
		}
		if (length > 2 && (line[0] == '#' || line[0] == '/')) {
			h->comment = line;
			h->comment_length = length;
		}
	}
	return false;
}

/* Whether word `index` of a line is a number. */
static bool has_number(const char *line, size_t length, size_t index)
{
	text_names words;
	double value;
	bool found = text_names_split(&words, line, length, NULL) == GW_OK && index < words.count;
	if (found) {
		size_t size = strlen(words.name[index]);
		found = size > 0 && number_read(words.name[index], size, &value) == size;
	}
	text_names_clear(&words);
	return found;
}

static size_t index_of(const text_names *names, const char *name)
{
	size_t i = 0;
	while (i < names->count && strcmp(names->name[i], name) != 0)
		i++;
	return i;
}

/* Steps over the head's line, which held names. */
static gw_status step_over(text_rows *rows, const head *h, gw_error *error)
{
	head next;
	rows->begin = h->behind;
	rows->first_line = h->number + 1;
	if (!find_head(rows, &next))
		return gw_fail(error, GW_ERROR_DATA, "%s holds no points, only names of columns",
					   rows->in->name);
	rows->separator = text_rows_separator(next.line, next.length);
	return GW_OK;
}

/* line: of the names; 0 when the user gave them */
static gw_status check_names(const text_rows *rows, const text_names *names, size_t line,
							 gw_error *error)
{
	const char *twice = names->count <= TEXT_COLUMNS_MAX ? text_names_repeated(names) : NULL;
	const char *where = line ? rows->in->name : "--columns";
	gw_status class = line ? GW_ERROR_DATA : GW_ERROR_USAGE;
	if (names->count > TEXT_COLUMNS_MAX)
		return gw_fail(error, class, "%s names more than %d columns", where, TEXT_COLUMNS_MAX);
	if (text_names_have_position(names) && !twice)
		return GW_OK;
	if (text_names_have_position(names))
		return gw_fail(error, class, "%s: two columns are called '%.40s'; rename one of them",
					   where, twice);
	if (line == 0)
		return gw_fail(error, class, "--columns %.200s: there must be x, y and z among them",
					   rows->in->columns);
	return gw_fail(error, class,
				   "%s, line %zu is neither a row of numbers nor of names with x, y and z; name "
				   "the columns with --columns",
				   where, line);
}

/* Names as the user says; a first line without a number where x should be is one of names. */
static gw_status take_given(text_rows *rows, const head *h, text_names *names, gw_error *error)
{
	GW_TRY(text_names_split(names, rows->in->columns, strlen(rows->in->columns), error));
	GW_TRY(check_names(rows, names, 0, error));
	rows->open = true;
	if (!has_number(h->line, h->length, index_of(names, "x")))
		GW_TRY(step_over(rows, h, error));
	return GW_OK;
}

/* A comment before the first row that names as many columns as it has. */
static gw_status take_comment(const text_rows *rows, const head *h, text_names *names,
							  gw_error *error)
{
	double value[64];
	if (!h->comment)
		return GW_OK;
	size_t width = text_rows_numbers(h->line, h->length, rows->separator, value, 64);
	GW_TRY(text_names_split(names, h->comment, h->comment_length, error));
	if (names->count != width || !text_names_have_position(names) || text_names_repeated(names))
		text_names_clear(names);
	return GW_OK;
}

/* *comment becomes the one that held names, or NULL. */
static gw_status find_names(text_rows *rows, text_names *names, const char **comment,
							gw_error *error)
{
	head h;
	double value[64];
	if (!find_head(rows, &h))
		return gw_fail(error, GW_ERROR_DATA, "%s holds no points", rows->in->name);
	rows->separator = text_rows_separator(h.line, h.length);
	if (rows->in->columns)
		return take_given(rows, &h, names, error);
	if (text_rows_numbers(h.line, h.length, rows->separator, value, 64) > 0) {
		GW_TRY(take_comment(rows, &h, names, error));
		*comment = names->count ? h.comment : NULL;
		return names->count ? GW_OK : text_names_guess(names, rows, false, error);
	}
	GW_TRY(text_names_split(names, h.line, h.length, error));
	rows->skip = TEXT_ROWS_SKIP_LONG;
	GW_TRY(check_names(rows, names, h.number, error));
	return step_over(rows, &h, error);
}

/* Comments before the first line of names or values are the scan's. */
static gw_status take_comments(const text_rows *rows, const char *names, scan *cloud,
							   gw_error *error)
{
	const char *at = text_rows_begin(rows->in->data, rows->in->length), *line;
	size_t length;
	gw_status status = GW_OK;
	while (status == GW_OK && at < rows->end &&
		   text_rows_next_line(&at, rows->end, rows->newline, &line, &length) &&
		   text_rows_is_empty(line, length)) {
		if (length < 2 || line == names || line[0] != '#' || line[1] != ' ')
			continue;
		char *text = strndup(line + 2, length - 2 - (line[length - 1] == '\r'));
		status = text ? scan_add_comment(cloud, text, error)
					  : gw_fail(error, GW_ERROR_MEMORY, "no memory for a comment line");
		free(text);
	}
	return status;
}

static gw_status open_named(text_rows *rows, text_names *names, text_stream *s, gw_error *error)
{
	const char *comment = NULL;
	scan facts = { .count = 0 };
	GW_TRY(find_names(rows, names, &comment, error));
	gw_status status = take_comments(rows, comment, &facts, error);
	if (status != GW_OK) {
		scan_clear(&facts);
		return status;
	}
	*s = text_stream_make(rows, names);
	s->facts = facts;
	return GW_OK;
}

static gw_status open_table(const input_file *in, text_stream *s, gw_error *error)
{
	const char *text = text_rows_begin(in->data, in->length);
	const char *end = (const char *)in->data + in->length;
	text_rows rows = { .in = in, .begin = text, .end = end, .first_line = 1 };
	text_names names = { 0 };
	*s = (text_stream){ .end = NULL };
	rows.newline = text_rows_newline(text, end);
	gw_status status = open_named(&rows, &names, s, error);
	text_names_clear(&names);
	return status;
}

gw_status xyz_read(input_file *in, scan *cloud, gw_error *error)
{
	return text_stream_read(in, open_table, cloud, error);
}

static gw_status stream_open(input_file *in, void **state, gw_error *error)
{
	return text_stream_new(in, open_table, state, error);
}

static const format_stream xyz_stream = { text_stream_guess, stream_open, text_stream_next_piece,
										  text_stream_free };

/* ------------------------------------------------------------------------------- the formats */

/* Text whose first line that is no comment has three numbers or more, or names x, y and z. */
static bool probe(const uint8_t *data, size_t length)
{
	text_rows rows = { .begin = text_rows_begin(data, length) };
	text_names names;
	double value[64];
	head h;
	length = length < HEAD_BYTES ? length : HEAD_BYTES;
	rows.end = (const char *)data + length;
	rows.newline = text_rows_newline(rows.begin, rows.end);
	if (memchr(data, 0, length) || !find_head(&rows, &h))
		return false;
	if (text_rows_numbers(h.line, h.length, text_rows_separator(h.line, h.length), value, 64) >= 3)
		return true;
	bool found = text_names_split(&names, h.line, h.length, NULL) == GW_OK &&
				 text_names_have_position(&names);
	text_names_clear(&names);
	return found;
}

static const char *const xyz_extensions[] = { "xyz", "txt", "asc", "pwn", "xyzn", "xyzrgb", NULL };

const format xyz_format = {
	.name = "xyz",
	.description = "table of text, columns parted by blanks, commas or semicolons",
	.extensions = xyz_extensions,
	.probe = probe,
	.unspecific = true,
	.read = xyz_read,
	.stream = &xyz_stream,
	.text = true,
	.write = xyz_write,
	.parted = &xyz_parted,
};

static const char *const csv_extensions[] = { "csv", NULL };

const format csv_format = {
	.name = "csv",
	.description = "table of text with a first line of names, columns parted by commas",
	.extensions = csv_extensions,
	.read = xyz_read,
	.stream = &xyz_stream,
	.text = true,
	.write = csv_write,
	.parted = &csv_parted,
};
