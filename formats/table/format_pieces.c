/* format_pieces.c - see format_pieces.h. */
#include "table/format_pieces.h"

#include "table/format_table.h"

#include <string.h>

/* Bytes that a point takes at least in most files, by which they are guessed where nothing says
 * how many there are. */
#define POINT_BYTES 16u

gw_status format_pieces_open(const char *path, const format_options *options, format_pieces *p,
							 gw_error *error)
{
	*p = (format_pieces){ .path = path, .options = *options };
	GW_TRY(format_parts_open(path, options, &p->parts, error));
	input_file *in = &p->parts.in;
	if (!in->data)
		return GW_OK;
	in->columns = options->columns;
	p->found = format_recognise(path, options->name, in);
	const format_stream *stream = p->found ? p->found->stream : NULL;
	p->together = !p->parts.found && !stream;
	p->guess = p->parts.found ? p->parts.count
			   : stream       ? stream->guess(in)
							  : in->length / POINT_BYTES;
	return GW_OK;
}

/* What read leaves out that knows all points, as far as these tell: columns without a value. */
static void leave_out_zeros(scan *piece)
{
	static const char *const place[3] = { "x", "y", "z" };
	for (size_t c = piece->column_count; c-- > 0;) {
		const scan_column *column = &piece->column[c];
		bool needed = false;
		for (int k = 0; k < 3; k++)
			needed = needed || strcmp(column->name, place[k]) == 0;
		if (!needed && scan_is_zero(column, piece->count))
			scan_remove_column(piece, column->name);
	}
}

/* Points of a file that can be read in parts, one part after the other. */
static gw_status next_part(format_pieces *p, size_t most, scan *piece, gw_error *error)
{
	uint64_t together = p->parts.together;
	size_t step = (size_t)(most > together ? most / together * together : together);
	if (p->next >= p->parts.count)
		return GW_OK;
	GW_TRY(format_parts_read(&p->parts, p->next, step, piece, error));
	p->next += step;
	if (p->found->settle_rows)
		leave_out_zeros(piece);
	return GW_OK;
}

static gw_status next_of_stream(format_pieces *p, size_t most, scan *piece, gw_error *error)
{
	const format_stream *stream = p->found->stream;
	gw_status status = GW_OK;
	if (!p->begun)
		status = stream->open(&p->parts.in, &p->stream, error);
	p->begun = true;
	if (status == GW_OK)
		status = stream->next(p->stream, most, piece, error);
	status = input_file_check(&p->parts.in, status, error);
	return format_finish(piece, status, error);
}

static gw_status all_at_once(format_pieces *p, scan *piece, gw_error *error)
{
	bool done = p->begun;
	p->begun = true;
	return done ? GW_OK : format_read_with(p->path, &p->options, piece, NULL, error);
}

gw_status format_pieces_next(format_pieces *p, size_t most, scan *piece, gw_error *error)
{
	*piece = (scan){ 0 };
	if (p->parts.found)
		return next_part(p, most, piece, error);
	return p->together ? all_at_once(p, piece, error) : next_of_stream(p, most, piece, error);
}

void format_pieces_close(format_pieces *p)
{
	if (p->stream)
		p->found->stream->close(p->stream);
	format_parts_close(&p->parts);
	*p = (format_pieces){ .path = NULL };
}
