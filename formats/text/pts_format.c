/*
 * PTS: counts on lines of their own, and rows of x y z, intensity, red green blue.
 */
#include "files/number_text.h"
#include "text/text_formats.h"
#include "text/text_stream.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEAD_BYTES (1 << 16)

static gw_status open_table(const input_file *in, text_stream *s, gw_error *error)
{
	const char *text = text_rows_begin(in->data, in->length), *line;
	const char *end = (const char *)in->data + in->length;
	text_rows rows = {
		.in = in, .begin = text, .end = end, .first_line = 1, .skip = TEXT_ROWS_SKIP_SINGLE
	};
	text_names names = { 0 };
	size_t length;
	*s = (text_stream){ .end = NULL };
	rows.newline = text_rows_newline(text, end);
	if (!text_rows_first(&rows, &line, &length))
		return gw_fail(error, GW_ERROR_DATA, "%s holds no points", in->name);
	rows.separator = text_rows_separator(line, length);
	gw_status status = text_names_guess(&names, &rows, true, error);
	if (status == GW_OK) {
		*s = text_stream_make(&rows, &names);
		s->counted = true;
	}
	text_names_clear(&names);
	return status;
}

gw_status pts_read(input_file *in, scan *cloud, gw_error *error)
{
	return text_stream_read(in, open_table, cloud, error);
}

static gw_status stream_open(input_file *in, void **state, gw_error *error)
{
	return text_stream_new(in, open_table, state, error);
}

static const format_stream pts_stream = { text_stream_guess, stream_open, text_stream_next_piece,
										  text_stream_free };

/* A count, and then a row of numbers. */
static bool probe(const uint8_t *data, size_t length)
{
	const char *at = (const char *)data, *line;
	double value[16];
	size_t line_length;
	length = length < HEAD_BYTES ? length : HEAD_BYTES;
	const char *end = at + length;
	char newline = text_rows_newline(at, end);
	if (!text_rows_next_line(&at, end, newline, &line, &line_length) || line_length > 24 ||
		text_rows_numbers(line, line_length, ' ', value, 16) != 1 || value[0] != trunc(value[0]))
		return false;
	return text_rows_next_line(&at, end, newline, &line, &line_length) &&
		   text_rows_numbers(line, line_length, ' ', value, 16) >= 3;
}

static const char *const extensions[] = { "pts", NULL };

const format pts_format = {
	.name = "pts",
	.description = "table of text with counts, x y z intensity red green blue",
	.extensions = extensions,
	.probe = probe,
	.read = pts_read,
	.stream = &pts_stream,
};
