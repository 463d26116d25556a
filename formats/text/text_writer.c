/*
 * Tables of text: rows are printed on all threads, a block of them at a time, and written in order.
 */
#include "files/number_text.h"
#include "glowworm_host.h"
#include "text/text_formats.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Stretches of rows that are printed and held at once, and the bytes that one may take. */
#define STRETCHES ((size_t)32)
#define STRETCH_BYTES ((size_t)1 << 20)

typedef struct writer {
	const scan *cloud;
	const char *separator;
	size_t rows;           /* of a stretch */
	size_t first;          /* row of the first stretch */
	char *text[STRETCHES]; /* owned */
	size_t length[STRETCHES];
} writer;

static size_t print_value(char *text, const scan_column *column, size_t i)
{
	if (column->type == SCAN_FLOAT64)
		return number_print(text, ((const double *)column->data)[i]);
	if (column->type == SCAN_FLOAT32)
		return number_print_float(text, ((const float *)column->data)[i]);
	return number_print(text, scan_value(column, i));
}

static void print_stretches(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	writer *w = user;
	for (size_t s = first; s < last; s++) {
		size_t row = w->first + s * w->rows, end = row + w->rows;
		char *at = w->text[s];
		for (; row < end && row < w->cloud->count; row++) {
			for (size_t c = 0; c < w->cloud->column_count; c++) {
				at += print_value(at, &w->cloud->column[c], row);
				*at++ = w->separator[0];
			}
			at[-1] = '\n';
		}
		w->length[s] = (size_t)(at - w->text[s]);
	}
}

static gw_status write_rows(output_file *out, writer *w, gw_error *error)
{
	size_t rows = w->cloud->count, block = w->rows * STRETCHES;
	for (w->first = 0; w->first < rows; w->first += block) {
		size_t left = rows - w->first < block ? rows - w->first : block;
		size_t stretches = (left + w->rows - 1) / w->rows;
		gw_parallel_for(0, stretches, 1, print_stretches, w);
		for (size_t s = 0; s < stretches; s++)
			GW_TRY(output_file_write(out, w->text[s], w->length[s], error));
	}
	return GW_OK;
}

static gw_status write_table(output_file *out, const scan *cloud, const char *separator,
							 gw_error *error)
{
	writer w = { .cloud = cloud, .separator = separator };
	size_t row_bytes = (cloud->column_count + 1) * NUMBER_TEXT;
	w.rows = row_bytes < STRETCH_BYTES ? STRETCH_BYTES / row_bytes : 1;
	size_t stretches = cloud->count / w.rows + 1;
	bool enough = cloud->column_count > 0;
	for (size_t s = 0; s < STRETCHES && s < stretches && enough; s++) {
		w.text[s] = reallocarray(NULL, row_bytes, w.rows);
		enough = w.text[s] != NULL;
	}
	gw_status status = GW_OK;
	if (!enough && cloud->column_count > 0)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	if (enough)
		status = write_rows(out, &w, error);
	for (size_t s = 0; s < STRETCHES; s++)
		free(w.text[s]);
	return status;
}

/* Text on one line: whatever could end it, or part columns, becomes another character. */
static gw_status write_word(output_file *out, const char *text, const char *bad, char instead,
							gw_error *error)
{
	char *copy = strdup(text);
	if (!copy)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	for (char *c = copy; *c; c++)
		if ((unsigned char)*c < ' ' || strchr(bad, *c))
			*c = instead;
	gw_status status = output_file_print(out, error, "%s", *copy ? copy : "unnamed");
	free(copy);
	return status;
}

static gw_status write_names(output_file *out, const scan *cloud, const char *separator,
							 const char *bad, gw_error *error)
{
	for (size_t c = 0; c < cloud->column_count; c++) {
		output_file_print(out, NULL, "%s", c ? separator : "");
		GW_TRY(write_word(out, cloud->column[c].name, bad, '_', error));
	}
	return output_file_print(out, error, "\n");
}

static bool is_plain(const scan *cloud)
{
	return cloud->column_count == 3 && scan_find(cloud, "x") == &cloud->column[0] &&
		   scan_find(cloud, "y") == &cloud->column[1] && scan_find(cloud, "z") == &cloud->column[2];
}

static gw_status write_xyz_head(output_file *out, const format_whole *whole, const scan *cloud,
								gw_error *error)
{
	(void)whole;
	for (size_t c = 0; c < cloud->comment_count; c++) {
		output_file_print(out, NULL, "# ");
		GW_TRY(write_word(out, cloud->comment[c], "", ' ', error));
		output_file_print(out, NULL, "\n");
	}
	if (is_plain(cloud))
		return GW_OK;
	output_file_print(out, NULL, "# ");
	return write_names(out, cloud, " ", " \",;", error);
}

static gw_status write_xyz_rows(output_file *out, const format_whole *whole, const scan *part,
								gw_error *error)
{
	(void)whole;
	return write_table(out, part, " ", error);
}

static gw_status write_csv_head(output_file *out, const format_whole *whole, const scan *cloud,
								gw_error *error)
{
	(void)whole;
	return write_names(out, cloud, ",", "\",;", error);
}

static gw_status write_csv_rows(output_file *out, const format_whole *whole, const scan *part,
								gw_error *error)
{
	(void)whole;
	return write_table(out, part, ",", error);
}

gw_status xyz_write(output_file *out, const scan *cloud, gw_error *error)
{
	GW_TRY(write_xyz_head(out, NULL, cloud, error));
	return write_table(out, cloud, " ", error);
}

gw_status csv_write(output_file *out, const scan *cloud, gw_error *error)
{
	GW_TRY(write_csv_head(out, NULL, cloud, error));
	return write_table(out, cloud, ",", error);
}

const format_parted xyz_parted = {
	.any_length = true,
	.write_head = write_xyz_head,
	.write_rows = write_xyz_rows,
};

const format_parted csv_parted = {
	.any_length = true,
	.write_head = write_csv_head,
	.write_rows = write_csv_rows,
};
