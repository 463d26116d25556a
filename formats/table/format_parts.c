/* format_parts.c - see format_parts.h. */
#include "table/format_parts.h"

#include "table/format_table.h"

gw_status format_parts_open(const char *path, const format_options *options, format_parts *parts,
							gw_error *error)
{
	*parts = (format_parts){ .found = NULL };
	GW_TRY(input_file_open_as(&parts->in, path, 0, 0, error));
	parts->in.threads = options->threads;
	const format *found = format_recognise(path, options->name, &parts->in);
	/* What was copied is gone once it was read. */
	bool mapped = parts->in.storage == INPUT_FILE_MAPPED;
	if (mapped && found && found->count_rows)
		parts->count = found->count_rows(&parts->in);
	parts->found = parts->count > 0 ? found : NULL;
	return GW_OK;
}

gw_status format_parts_read(format_parts *parts, uint64_t first, size_t count, scan *part,
							gw_error *error)
{
	uint64_t left = first < parts->count ? parts->count - first : 0;
	const format_rows rows = { first, count < left ? count : left };
	gw_status status = parts->found->read_rows(&parts->in, &rows, part, error);
	status = input_file_check(&parts->in, status, error);
	return format_finish(part, status, error);
}

void format_parts_close(format_parts *parts)
{
	input_file_close(&parts->in);
	*parts = (format_parts){ .found = NULL };
}
