/* parted_copy.c - see parted_copy.h. */
#include "result/parted_copy.h"

#include "glowworm_host.h"
#include "options/output_columns.h"
#include "options/output_name.h"
#include "options/output_system.h"
#include "program/signals.h"
#include "result/las_step.h"
#include "scene/gathered_cloud.h"

#include <stdio.h>
#include <stdlib.h>

/* Whether memory holds all points, by the columns of some, with what is made of them. */
static bool memory_holds(const parted_copy *c, const scan *some)
{
	uint64_t row = 0, available = gw_available_memory() / 2;
	for (size_t k = 0; k < some->column_count; k++)
		row += scan_type_size(some->column[k].type);
	return row > 0 && c->parts.count <= available / row;
}

/* Where scanners were is of no use to LAS, whose readers find it again. */
static bool needs_scanners(const parted_copy *c)
{
	return c->parts.found->needs_all && !c->format->needs_all;
}

/* What the first point, or the first part, says of whether all are better read at once. */
static gw_status look_at_first(parted_copy *c, bool *parted, gw_error *error)
{
	scan first;
	bool packed = c->parts.found->packed;
	if (!packed && !needs_scanners(c))
		return GW_OK;
	GW_TRY(format_parts_read(&c->parts, 0, packed ? 1 : c->step, &first, error));
	bool all = packed || format_parts_need_all(&c->parts, &first);
	*parted = !(all && memory_holds(c, &first));
	scan_clear(&first);
	return GW_OK;
}

/* A file that cannot be read in parts is gathered first, where memory does not hold it. */
static gw_status gather(parted_copy *c, gw_error *error)
{
	const gathered_cloud_use use = { .output = c->path,
									 .memory = gw_available_memory(),
									 .quiet = true };
	gathered_input *input = NULL;
	format_parts_close(&c->parts);
	gw_status status =
		use.memory > 0 ? gathered_cloud_make(c->settings, &use, &c->parts, &input, error) : GW_OK;
	free(input);
	return status;
}

gw_status parted_copy_open(parted_copy *c, const format_options *options, bool *parted,
						   gw_error *error)
{
	*parted = false;
	if (!output_name_takes_parts(c->path, c->format))
		return GW_OK;
	GW_TRY(format_parts_open(c->settings->input[0].path, options, &c->parts, error));
	if (!c->parts.found)
		GW_TRY(gather(c, error));
	uint64_t together = c->parts.together;
	*parted = c->parts.found && together <= PARTED_COPY_POINTS;
	if (!*parted)
		return GW_OK;
	c->step = (size_t)(PARTED_COPY_POINTS / together * together);
	return look_at_first(c, parted, error);
}

/* --------------------------------------------------------------------------------- all points */

/* Reads all parts, of which format_parts keeps account. */
static gw_status read_through(parted_copy *c, gw_error *error)
{
	for (uint64_t first = 0; first < c->parts.count; first += c->step) {
		scan part;
		GW_TRY(parted_copy_read(c, first, &part, error));
		scan_clear(&part);
		GW_TRY(signals_check(error));
	}
	return GW_OK;
}

/* What the output's format has to know of all points, and else what has to be known of them. */
static gw_status survey(parted_copy *c, gw_error *error)
{
	const format_survey_use use = { c->format, c->step, signals_check };
	c->whole.name = output_file_name(c->output);
	GW_TRY(format_parts_survey(&c->parts, &use, &c->whole, error));
	if (!c->format->parted->survey_begin && (c->parts.found->settle_rows || c->shift->wanted))
		GW_TRY(read_through(c, error));
	return GW_OK;
}

/* Which columns there are, where all points tell.
 *   lost   receives whether all of them at once may tell where scanners were */
static gw_status settle_columns(parted_copy *c, bool *lost, gw_error *error)
{
	GW_TRY(format_parts_read(&c->parts, 0, 1, &c->told, error));
	*lost = needs_scanners(c) && format_parts_need_all(&c->parts, &c->told);
	if (!c->parts.found->settle_rows)
		return GW_OK;
	GW_TRY(format_parts_settle(&c->parts, &c->told, error));
	return format_parts_follow(&c->parts, &c->told, error);
}

gw_status parted_copy_settle(parted_copy *c, bool *parted, gw_error *error)
{
	GW_TRY(survey(c, error));
	bool lost;
	GW_TRY(settle_columns(c, &lost, error));
	bool joined = c->format->parted->one_scan && c->told.scanner_count > 1;
	*parted = !((lost || joined) && memory_holds(c, &c->told)) &&
			  !las_step_needs_all(c->settings, &c->told);
	if (*parted && lost && !c->settings->quiet)
		fprintf(stderr, "glowworm: note: memory does not hold all points at once, which tell where "
						"the scanner flew; the output does not say it\n");
	if (*parted && joined && !c->settings->quiet)
		fprintf(stderr,
				"glowworm: note: memory does not hold all points at once; those of %zu "
				"scanners are written as one scan\n",
				c->told.scanner_count);
	return GW_OK;
}

void parted_copy_settle_shift(parted_copy *c)
{
	output_shift_settle(c->shift, c->parts.minimum, c->parts.maximum, c->settings->quiet);
}

/* LAS and its kin, which alone have a step, are surveyed: all parts were read. */
gw_status parted_copy_check_step(const parted_copy *c, gw_error *error)
{
	return output_system_check_step(c->settings, &c->told, c->parts.minimum, c->parts.maximum,
									error);
}

/* --------------------------------------------------------------------------------- part by part
 */

gw_status parted_copy_read(parted_copy *c, uint64_t first, scan *part, gw_error *error)
{
	return format_parts_read(&c->parts, first, c->step, part, error);
}

static gw_status begin(parted_copy *c, const scan *first, gw_error *error)
{
	uint64_t row = c->format->row_bytes;
	for (size_t k = 0; k < first->column_count && c->format->row_bytes == 0; k++)
		row += c->format->text ? 2 : scan_type_size(first->column[k].type);
	GW_TRY(output_file_check_room(c->path, row * c->whole.count, error));
	c->begun = true;
	output_columns_note(c->format, first, c->settings->quiet);
	return c->format->parted->write_head(c->output, &c->whole, first, error);
}

gw_status parted_copy_write(parted_copy *c, const scan *part, gw_error *error)
{
	if (!c->begun)
		GW_TRY(begin(c, part, error));
	return c->format->parted->write_rows(c->output, &c->whole, part, error);
}

gw_status parted_copy_end(parted_copy *c, gw_error *error)
{
	const format_parted *to = c->format->parted;
	return to->write_end ? to->write_end(c->output, &c->whole, error) : GW_OK;
}

void parted_copy_close(parted_copy *c)
{
	format_whole_clear(c->format, &c->whole);
	scan_clear(&c->told);
	format_parts_close(&c->parts);
}
