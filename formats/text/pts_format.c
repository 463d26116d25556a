/*
 * PTS: counts on lines of their own, and rows of x y z, intensity, red green blue.
 */
#include "files/number_text.h"
#include "text/text_columns.h"
#include "text/text_formats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEAD_BYTES (1 << 16)

/* Adds up the lines of one number. False when one of them is no count. */
static bool sum_counts(const text_rows *rows, size_t most, double *sum)
{
	const char *at = rows->begin, *line;
	size_t length, found = 0;
	*sum = 0.0;
	while (found < most && text_rows_next_line(&at, rows->end, rows->newline, &line, &length)) {
		double value;
		if (text_rows_is_empty(line, length) ||
			text_rows_numbers(line, length < 64 ? length : 64, rows->separator, &value, 1) != 1)
			continue;
		if (!(value >= 0.0 && value == trunc(value)))
			return false;
		*sum += value;
		found++;
	}
	return true;
}

/* The counts, if there are any, must agree with the rows. */
static gw_status check_counts(const text_rows *rows, gw_error *error)
{
	double sum = 0.0;
	if (rows->skipped == 0)
		return GW_OK;
	if (!sum_counts(rows, rows->skipped, &sum))
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: a line with a single number is no count of points", rows->in->name);
	if (sum != (double)rows->count)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: lines with a single number count %.0f points, but %zu follow; the file "
					   "is cut short, or the count is wrong: read it with --format xyz after "
					   "removing that line",
					   rows->in->name, sum, rows->count);
	return GW_OK;
}

static gw_status read_rows(text_rows *rows, const text_names *names, scan *cloud, gw_error *error)
{
	GW_TRY(text_rows_count(rows, error));
	gw_status status = check_counts(rows, error);
	cloud->count = rows->count;
	if (status == GW_OK)
		status = text_columns_read(rows, names, cloud, error);
	text_rows_clear(rows);
	return status;
}

gw_status pts_read(input_file *in, scan *cloud, gw_error *error)
{
	const char *text = text_rows_begin(in->data, in->length);
	const char *end = (const char *)in->data + in->length;
	text_rows rows = {
		.in = in, .begin = text, .end = end, .first_line = 1, .skip = TEXT_ROWS_SKIP_SINGLE
	};
	text_names names = { 0 };
	*cloud = (scan){ .up = 'z' };
	rows.newline = text_rows_newline(text, end);
	const char *line;
	size_t length;
	bool any = text_rows_first(&rows, &line, &length);
	if (any)
		rows.separator = text_rows_separator(line, length);
	gw_status status = any ? text_names_guess(&names, &rows, true, error)
						   : gw_fail(error, GW_ERROR_DATA, "%s holds no points", in->name);
	if (status == GW_OK)
		status = read_rows(&rows, &names, cloud, error);
	text_names_clear(&names);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

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
};
