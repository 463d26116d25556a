/* format_parts.c - see format_parts.h. */
#include "table/format_parts.h"

#include "points/scan_shift.h"
#include "table/format_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* No pipe, and something is in it. */
static bool can_be_read_twice(const char *path)
{
	struct stat info;
	return strcmp(path, "-") != 0 && stat(path, &info) == 0 && S_ISREG(info.st_mode) &&
		   info.st_size > 0;
}

static format_parts no_parts(void)
{
	return (format_parts){ .found = NULL,
						   .minimum = { INFINITY, INFINITY, INFINITY },
						   .maximum = { -INFINITY, -INFINITY, -INFINITY } };
}

/* Of points that were gathered all is known that their files say. */
static const format gathered_format = { .name = "gathered points" };

void format_parts_of_gathered(gathered_points *gathered, const char *name, format_parts *parts)
{
	*parts = no_parts();
	parts->gathered = gathered;
	parts->in.name = name;
	parts->found = &gathered_format;
	parts->count = gathered_points_count(gathered);
	parts->together = 1;
}

gw_status format_parts_open(const char *path, const format_options *options, format_parts *parts,
							gw_error *error)
{
	*parts = no_parts();
	if (!can_be_read_twice(path))
		return GW_OK;
	GW_TRY(input_file_open_as(&parts->in, path, 0, 0, error));
	parts->in.threads = options->threads;
	const format *found = format_recognise(path, options->name, &parts->in);
	/* What was copied is gone once it was read. */
	bool mapped = parts->in.storage == INPUT_FILE_MAPPED;
	if (mapped && found && found->count_rows)
		parts->count = found->count_rows(&parts->in, &parts->together);
	parts->found = parts->count > 0 ? found : NULL;
	return GW_OK;
}

static gw_status read_part(format_parts *parts, uint64_t first, size_t count, scan *part,
						   gw_error *error)
{
	uint64_t left = first < parts->count ? parts->count - first : 0;
	const format_rows rows = { first, count < left ? count : left };
	if (parts->gathered)
		return gathered_points_read(parts->gathered, first, (size_t)rows.count, part, error);
	gw_status status = parts->found->read_rows(&parts->in, &rows, part, error);
	status = input_file_check(&parts->in, status, error);
	return format_finish(part, status, error);
}

static gw_status note_values(format_parts *parts, const scan *part, gw_error *error)
{
	if (!parts->zero) {
		parts->columns = part->column_count;
		parts->zero = malloc(parts->columns + 1);
		if (!parts->zero)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the columns of %s",
						   parts->in.name);
		memset(parts->zero, true, parts->columns);
	}
	for (size_t c = 0; c < parts->columns && c < part->column_count; c++)
		parts->zero[c] = parts->zero[c] && scan_is_zero(&part->column[c], part->count);
	scan_shift_bounds(part, parts->minimum, parts->maximum);
	return GW_OK;
}

static void leave_out(const format_parts *parts, scan *part)
{
	for (size_t c = parts->columns; c-- > 0;)
		if (parts->left_out[c] && c < part->column_count)
			scan_remove_column(part, part->column[c].name);
}

gw_status format_parts_read(format_parts *parts, uint64_t first, size_t count, scan *part,
							gw_error *error)
{
	GW_TRY(read_part(parts, first, count, part, error));
	if (parts->left_out) {
		leave_out(parts, part);
		return GW_OK;
	}
	gw_status status = note_values(parts, part, error);
	if (status != GW_OK)
		scan_clear(part);
	return status;
}

static format_seen seen_of(const format_parts *parts)
{
	format_seen seen = { .zero = parts->zero };
	memcpy(seen.minimum, parts->minimum, sizeof seen.minimum);
	memcpy(seen.maximum, parts->maximum, sizeof seen.maximum);
	return seen;
}

gw_status format_parts_settle(format_parts *parts, scan *kept, gw_error *error)
{
	if (!parts->found->settle_rows || !parts->zero || kept->column_count != parts->columns)
		return GW_OK;
	const format_seen seen = seen_of(parts);
	return parts->found->settle_rows(&parts->in, &seen, kept, error);
}

bool format_parts_need_all(const format_parts *parts, const scan *some)
{
	const format_seen seen = seen_of(parts);
	return parts->found->needs_all && parts->zero && some->column_count == parts->columns &&
		   parts->found->needs_all(some, &seen);
}

gw_status format_parts_follow(format_parts *parts, const scan *kept, gw_error *error)
{
	scan one;
	GW_TRY(read_part(parts, 0, 1, &one, error));
	parts->columns = one.column_count;
	parts->left_out = calloc(parts->columns + 1, sizeof *parts->left_out);
	for (size_t c = 0; c < parts->columns && parts->left_out; c++)
		parts->left_out[c] = !scan_find(kept, one.column[c].name);
	scan_clear(&one);
	return parts->left_out
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_MEMORY, "no memory for the columns of %s", parts->in.name);
}

/* One round. */
static gw_status survey_parts(format_parts *parts, const format_survey_use *use,
							  format_whole *whole, gw_error *error)
{
	for (uint64_t first = 0; first < parts->count; first += use->step) {
		scan part;
		GW_TRY(format_parts_read(parts, first, use->step, &part, error));
		gw_status status = use->format->parted->survey_add(whole, &part, error);
		scan_clear(&part);
		GW_TRY(status);
		GW_TRY(use->check(error));
	}
	return GW_OK;
}

gw_status format_parts_survey(format_parts *parts, const format_survey_use *use,
							  format_whole *whole, gw_error *error)
{
	const format_parted *parted = use->format->parted;
	whole->count = parts->count;
	if (!parted->survey_begin)
		return GW_OK;
	GW_TRY(parted->survey_begin(whole, error));
	for (bool again = true; again;) {
		GW_TRY(survey_parts(parts, use, whole, error));
		again = false;
		if (parted->survey_go_on)
			GW_TRY(parted->survey_go_on(whole, &again, error));
	}
	return GW_OK;
}

void format_whole_clear(const format *to, format_whole *whole)
{
	if (to && to->parted && to->parted->survey_clear)
		to->parted->survey_clear(whole);
	else
		free(whole->survey);
	*whole = (format_whole){ .count = 0 };
}

gw_status format_whole_row(const format *to, const format_whole *whole, const scan *part,
						   size_t *row, gw_error *error)
{
	if (to->parted->row)
		return to->parted->row(whole, part, row, error);
	*row = 0;
	for (size_t c = 0; c < part->column_count; c++)
		*row += scan_type_size(part->column[c].type);
	return GW_OK;
}

void format_parts_close(format_parts *parts)
{
	input_file_close(&parts->in);
	gathered_points_close(&parts->gathered);
	free(parts->zero);
	free(parts->left_out);
	*parts = (format_parts){ .found = NULL };
}
