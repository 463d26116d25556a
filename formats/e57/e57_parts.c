/*
 * E57 that is written part by part: one scan, whose integers have limits that are known of all
 * points before. How long the description is, in which floats have limits, too, is put into the
 * header when all else is written.
 */
#include "e57/e57_format.h"
#include "e57/e57_packets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* E57's own part of format.parted. */
typedef struct format_survey {
	e57_known known;
	e57_column_limits *limits; /* owned: known.column */
	scan said;                 /* comments, and where the scanner stood, of the first part */
	e57_layout layout;         /* of all points, of said */
	e57_packets packets;
	uint8_t *pending; /* owned: rows of a packet that is not full */
	size_t pending_count;
	uint8_t page[E57_PAGE]; /* the file's first */
} e57_survey;

static gw_status fail_memory(const format_whole *whole, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", whole->name);
}

/* ------------------------------------------------------------------------------- before */

static gw_status survey_begin(format_whole *whole, gw_error *error)
{
	whole->survey = calloc(1, sizeof *whole->survey);
	if (!whole->survey)
		return fail_memory(whole, error);
	whole->survey->known.finite = true;
	return GW_OK;
}

/* Only of whole numbers limits are needed before they are written. */
static gw_status begin_limits(format_whole *whole, const scan *part, gw_error *error)
{
	e57_survey *survey = whole->survey;
	survey->limits = calloc(part->column_count + 1, sizeof *survey->limits);
	if (!survey->limits)
		return fail_memory(whole, error);
	survey->known.column = survey->limits;
	for (const scan_column *c = part->column; c < part->column + part->column_count; c++) {
		if (c->type == SCAN_FLOAT32 || c->type == SCAN_FLOAT64)
			continue;
		e57_column_limits own = { strdup(c->name), c->type, INFINITY, -INFINITY };
		if (!own.name)
			return fail_memory(whole, error);
		survey->limits[survey->known.column_count++] = own;
	}
	return GW_OK;
}

static gw_status survey_add(format_whole *whole, const scan *part, gw_error *error)
{
	static const char *const axis[3] = { "x", "y", "z" };
	e57_survey *survey = whole->survey;
	if (!survey->limits)
		GW_TRY(begin_limits(whole, part, error));
	survey->known.count += part->count;
	for (size_t c = 0; survey->limits && c < survey->known.column_count; c++) {
		e57_column_limits *limits = &survey->limits[c];
		const scan_column *column = scan_find(part, limits->name);
		for (size_t i = 0; column && i < part->count; i++) {
			double value = scan_value(column, i);
			limits->low = fmin(limits->low, value);
			limits->high = fmax(limits->high, value);
		}
	}
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(part, axis[k]);
		for (size_t i = 0; column && i < part->count && survey->known.finite; i++)
			survey->known.finite = isfinite(scan_value(column, i));
	}
	return GW_OK;
}

static gw_status survey_go_on(format_whole *whole, bool *again, gw_error *error)
{
	*again = false;
	if (whole->survey->known.count == whole->count)
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA, "%s: the input has %llu points now, and had %llu",
				   whole->name, (unsigned long long)whole->survey->known.count,
				   (unsigned long long)whole->count);
}

static void survey_clear(format_whole *whole)
{
	e57_survey *survey = whole->survey;
	if (!survey)
		return;
	for (size_t c = 0; c < survey->known.column_count; c++)
		free(survey->limits[c].name);
	free(survey->limits);
	free(survey->pending);
	e57_packets_clear(&survey->packets);
	e57_layout_clear(&survey->layout);
	scan_clear(&survey->said);
	free(survey);
	whole->survey = NULL;
}

static gw_status row(const format_whole *whole, const scan *part, size_t *bytes, gw_error *error)
{
	e57_layout layout;
	gw_status status = e57_layout_of_part(part, &whole->survey->known, whole->name, &layout, error);
	*bytes = status == GW_OK ? e57_records_row(&layout.scan[0]) : 0;
	e57_layout_clear(&layout);
	return status;
}

/* ------------------------------------------------------------------------------- the head */

/* What of the first part is needed when all are written. */
static gw_status keep_said(e57_survey *survey, const scan *first, gw_error *error)
{
	scan *said = &survey->said;
	for (size_t c = 0; c < first->comment_count; c++)
		GW_TRY(scan_add_comment(said, first->comment[c], error));
	for (size_t c = 0; c < first->column_count; c++)
		if (!scan_add_column(said, first->column[c].name, first->column[c].type, error))
			return GW_ERROR_MEMORY;
	if (first->scanner_count == 1 && !first->scanner_of)
		return scan_add_scanner(said, first->scanner, 0, 0, error);
	return GW_OK;
}

static gw_status write_head(output_file *out, const format_whole *whole, const scan *first,
							gw_error *error)
{
	e57_survey *survey = whole->survey;
	if (!output_file_temporary(out))
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: E57 is written part by part to files alone, because it says before the "
					   "points what is known after them; write PLY",
					   whole->name);
	GW_TRY(keep_said(survey, first, error));
	GW_TRY(e57_layout_of_part(&survey->said, &survey->known, whole->name, &survey->layout, error));
	GW_TRY(e57_packets_begin(&survey->packets, out, error));
	const e57_out_scan *s = &survey->layout.scan[0];
	survey->pending = reallocarray(NULL, s->packet, e57_records_row(s));
	if (!survey->pending)
		return fail_memory(whole, error);
	survey->packets.sink.first = survey->page;
	e57_packets_header(&survey->packets, &survey->layout, 0);
	e57_packets_section(&survey->packets, s);
	return GW_OK;
}

/* ------------------------------------------------------------------------------- the points */

static void write_packet(e57_survey *survey)
{
	e57_out_scan *s = &survey->layout.scan[0];
	const e57_packet packet = { .rows = survey->pending, .count = survey->pending_count };
	e57_rows_limits(s, packet.rows, packet.count);
	e57_packets_put(&survey->packets, s, &packet);
	survey->pending_count = 0;
}

static gw_status pack_loose(output_file *out, const format_whole *whole, const format_loose *rows,
							gw_error *error)
{
	e57_survey *survey = whole->survey;
	const e57_out_scan *s = &survey->layout.scan[0];
	for (size_t first = 0; first < rows->count;) {
		size_t room = s->packet - survey->pending_count, rest = rows->count - first;
		size_t count = rest < room ? rest : room;
		memcpy(survey->pending + survey->pending_count * rows->row, rows->bytes + first * rows->row,
			   count * rows->row);
		survey->pending_count += count;
		first += count;
		if (survey->pending_count == s->packet)
			write_packet(survey);
	}
	return output_file_write(out, "", 0, error);
}

/* Takes rows of a part, some at a time. */
typedef gw_status use_rows(output_file *out, const format_whole *whole, const format_loose *rows,
						   gw_error *error);

#define ROWS_TOGETHER ((size_t)1024)

static gw_status make_rows(output_file *out, const format_whole *whole, const scan *part,
						   use_rows *use, gw_error *error)
{
	e57_layout layout;
	uint8_t *bytes = NULL;
	gw_status status = e57_layout_of_part(part, &whole->survey->known, whole->name, &layout, error);
	const e57_out_scan *s = layout.scan;
	size_t length = status == GW_OK ? e57_records_row(s) : 0;
	if (status == GW_OK)
		bytes = reallocarray(NULL, ROWS_TOGETHER, length);
	if (status == GW_OK && !bytes)
		status = fail_memory(whole, error);
	for (size_t first = 0; first < part->count && status == GW_OK; first += ROWS_TOGETHER) {
		size_t rest = part->count - first, count = rest < ROWS_TOGETHER ? rest : ROWS_TOGETHER;
		e57_records_rows(&layout, s, first, count, bytes);
		status = use(out, whole, &(format_loose){ bytes, length, count }, error);
	}
	free(bytes);
	e57_layout_clear(&layout);
	return status;
}

static gw_status write_rows(output_file *out, const format_whole *whole, const scan *part,
							gw_error *error)
{
	return make_rows(out, whole, part, pack_loose, error);
}

static gw_status append_rows(output_file *out, const format_whole *whole, const format_loose *rows,
							 gw_error *error)
{
	(void)whole;
	return output_file_write(out, rows->bytes, rows->row * rows->count, error);
}

static gw_status write_loose(output_file *out, const format_whole *whole, const scan *part,
							 gw_error *error)
{
	return make_rows(out, whole, part, append_rows, error);
}

/* ------------------------------------------------------------------------------- the end */

static gw_status write_end(output_file *out, const format_whole *whole, gw_error *error)
{
	e57_survey *survey = whole->survey;
	size_t length;
	if (survey->pending_count > 0)
		write_packet(survey);
	GW_TRY(e57_packets_end(&survey->packets, &survey->layout, &length, error));
	e57_packets again = { .stretch = NULL }; /* whose page stays in memory, as it is not full */
	e57_packets_header(&again, &survey->layout, length);
	memcpy(survey->page, again.sink.page, E57_HEADER);
	e57_sink_seal(survey->page);
	return output_file_patch(out, 0, survey->page, E57_PAGE, error);
}

const format_parted e57_parted = {
	.one_scan = true,
	.survey_begin = survey_begin,
	.survey_add = survey_add,
	.survey_go_on = survey_go_on,
	.survey_clear = survey_clear,
	.row = row,
	.write_head = write_head,
	.write_rows = write_rows,
	.write_end = write_end,
	.write_loose = write_loose,
	.pack_loose = pack_loose,
};
