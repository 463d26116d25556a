/* text_stream.c - see text_stream.h. */
#include "text/text_stream.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of the begin of a text by which the number of its lines is guessed. */
#define GUESS_BYTES ((size_t)1 << 16)

text_stream text_stream_make(const text_rows *rows, text_names *names)
{
	text_stream s = { .rows = *rows, .end = rows->end, .names = *names };
	*names = (text_names){ 0 };
	s.rows.width = s.names.count;
	s.rows.end = s.rows.begin;
	return s;
}

void text_stream_clear(text_stream *s)
{
	text_names_clear(&s->names);
	scan_clear(&s->facts);
	*s = (text_stream){ .end = NULL };
}

const char *text_stream_skip(const text_rows *rows, const char *at, const char *end, size_t most,
							 size_t *found)
{
	*found = 0;
	while (at < end && *found < most) {
		const char *stop = memchr(at, rows->newline, (size_t)(end - at));
		at = stop ? stop + 1 : end;
		++*found;
	}
	return at;
}

/* The lines behind those that were read. */
static void go_on(text_stream *s, size_t most)
{
	text_rows *rows = &s->rows;
	rows->begin = rows->end;
	rows->first_line += s->lines;
	rows->end = text_stream_skip(rows, rows->begin, s->end, most, &s->lines);
}

/* Adds up the lines of one number. */
static gw_status add_counts(text_stream *s, gw_error *error)
{
	const char *at = s->rows.begin, *line;
	size_t length, left = s->counted ? s->rows.skipped : 0;
	while (left > 0 && text_rows_next_line(&at, s->rows.end, s->rows.newline, &line, &length)) {
		double value;
		if (text_rows_is_empty(line, length) ||
			text_rows_numbers(line, length < 64 ? length : 64, s->rows.separator, &value, 1) != 1)
			continue;
		if (!(value >= 0.0 && value == trunc(value)))
			return gw_fail(error, GW_ERROR_DATA,
						   "%s: a line with a single number is no count of points",
						   s->rows.in->name);
		s->counts += value;
		s->some_counts = true;
		left--;
	}
	return GW_OK;
}

/* The counts, if there are any, must agree with the rows. */
static gw_status check_counts(const text_stream *s, gw_error *error)
{
	if (!s->some_counts || s->counts == (double)s->found)
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA,
				   "%s: lines with a single number count %.0f points, but %llu follow; the file "
				   "is cut short, or the count is wrong: read it with --format xyz after "
				   "removing that line",
				   s->rows.in->name, s->counts, (unsigned long long)s->found);
}

static gw_status read_lines(text_stream *s, scan *piece, gw_error *error)
{
	GW_TRY(add_counts(s, error));
	piece->count = s->rows.count;
	piece->left_out += s->counted ? 0 : s->rows.skipped;
	s->found += s->rows.count;
	if (s->rows.end == s->end)
		GW_TRY(check_counts(s, error));
	for (size_t c = 0; c < s->facts.comment_count && !s->begun; c++)
		GW_TRY(scan_add_comment(piece, s->facts.comment[c], error));
	s->begun = s->begun || piece->count > 0;
	return text_columns_read(&s->rows, &s->names, piece, error);
}

gw_status text_stream_next(text_stream *s, size_t most, scan *piece, gw_error *error)
{
	gw_status status = GW_OK;
	*piece = (scan){ .up = 'z' };
	/* A piece without a row would say that there are no more. */
	while (status == GW_OK && piece->count == 0 && s->rows.end < s->end) {
		const char *before = s->rows.begin;
		const uint64_t left_out = piece->left_out;
		scan_clear(piece);
		*piece = (scan){ .up = 'z', .left_out = left_out };
		go_on(s, most);
		status = text_rows_count(&s->rows, error);
		if (status == GW_OK)
			status = read_lines(s, piece, error);
		text_rows_clear(&s->rows);
		input_file_release(s->rows.in, before, s->rows.begin);
	}
	if (status != GW_OK)
		scan_clear(piece);
	return status;
}

gw_status text_stream_read(const input_file *in, text_stream_opener *open, scan *cloud,
						   gw_error *error)
{
	text_stream s;
	*cloud = (scan){ .up = 'z' };
	gw_status status = open(in, &s, error);
	if (status == GW_OK)
		status = text_stream_next(&s, SIZE_MAX, cloud, error);
	text_stream_clear(&s);
	return status;
}

gw_status text_stream_new(const input_file *in, text_stream_opener *open, void **state,
						  gw_error *error)
{
	text_stream *s = calloc(1, sizeof *s);
	*state = s;
	return s ? open(in, s, error)
			 : gw_fail(error, GW_ERROR_MEMORY, "no memory to read %s", in->name);
}

gw_status text_stream_next_piece(void *state, size_t most, scan *piece, gw_error *error)
{
	return text_stream_next(state, most, piece, error);
}

void text_stream_free(void *state)
{
	if (state)
		text_stream_clear(state);
	free(state);
}

uint64_t text_stream_guess(input_file *in)
{
	size_t length = in->length < GUESS_BYTES ? in->length : GUESS_BYTES, lines = 1;
	char newline = text_rows_newline((const char *)in->data, (const char *)in->data + length);
	for (size_t i = 0; i < length; i++)
		lines += in->data[i] == (uint8_t)newline;
	return (uint64_t)((double)in->length / (double)length * (double)lines);
}
